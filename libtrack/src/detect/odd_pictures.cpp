#include "apriltrack/detect/odd_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "apriltrack/detect/chance_readings.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

/// Pictures are put right three ways, so that chance has three tries.
constexpr int kNumWays = 3;

GrayImage put_right(const GrayImage& image, const OddPictures& fault) {
  GrayImage right(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    std::copy_n(image.row(y), image.width(), right.row(y));
    if (fault.are_mirrored) std::reverse(right.row(y), right.row(y) + right.width());
    if (!fault.are_inverted) continue;
    for (int x = 0; x < right.width(); ++x) right(x, y) = static_cast<std::uint8_t>(255 - right(x, y));
  }
  return right;
}

/// Whether that many different tags are more than what chance reads. The number of its readings has a Poisson
/// distribution: it reads k or more with a probability below mean^k.
bool are_beyond_chance(const std::set<TagKey>& tags, const DetectorOptions& detector,
                       std::size_t num_images) {
  constexpr double kHardlyEver = 1e-3;
  double mean = 0.0;
  for (const std::string& family : detector.families)
    mean += chance_readings_per_frame(TagFamily::get(family), 0);
  mean *= static_cast<double>(kNumWays * num_images);
  return !tags.empty() && std::pow(mean, static_cast<double>(tags.size())) < kHardlyEver;
}

}  // namespace

std::optional<OddPictures> find_odd_pictures(std::span<const GrayImage> images,
                                             const DetectorOptions& detector) {
  DetectorOptions options = detector;
  // One search in the picture as it is will do, and corrected bits prove little.
  options.response = ResponseCurve::linear();
  options.rival_response.reset();
  options.search_raw_image_only = true;
  options.max_hamming = 0;
  options.decimate = 1.0;
  Detector finder(options);
  std::optional<OddPictures> found;
  for (OddPictures way : {OddPictures{.are_mirrored = true}, OddPictures{.are_inverted = true},
                          OddPictures{.are_mirrored = true, .are_inverted = true}}) {
    for (const GrayImage& image : images) {
      const std::vector<Detection> detections = finder.detect(put_right(image, way).view());
      for (const Detection& detection : detections) way.tags.insert(detection.tag);
      way.pictures += !detections.empty();
    }
    const bool is_better = !found || way.tags.size() > found->tags.size();
    if (is_better && are_beyond_chance(way.tags, options, images.size())) found = std::move(way);
  }
  return found;
}

}  // namespace apriltrack
