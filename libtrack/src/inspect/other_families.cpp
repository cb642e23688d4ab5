#include "other_families.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "apriltrack/base/parallel.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

/// All families at once, those asked for among them, lest their tags be taken for another's. One search in
/// the image as it is will do, and codes with a corrected bit prove nothing.
DetectorOptions options_for_all(const DetectorOptions& asked) {
  DetectorOptions options = asked;
  for (const std::string_view name : TagFamily::names())
    if (std::ranges::find(asked.families, name) == asked.families.end()) options.families.emplace_back(name);
  options.response = ResponseCurve::linear();
  options.search_raw_image_only = true;
  options.max_hamming = 0;
  options.decimate = 1.0;
  return options;
}

int resolved(int num_threads, std::size_t num_images) {
  constexpr unsigned kMost = 8;
  const int threads = num_threads > 0
                          ? num_threads
                          : static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, kMost));
  return std::min(threads, static_cast<int>(num_images));
}

/// One family's readings, image by image.
class ReadingsOfFamily {
 public:
  void add(const std::vector<Detection>& detections, const std::string& family) {
    std::set<int> ids;
    for (const Detection& detection : detections) {
      if (detection.tag.family != family) continue;
      ids.insert(detection.tag.id);
      margins_.push_back(detection.decision_margin.value_or(0.0));
    }
    frames_ += !ids.empty();
    for (const int id : ids) ++frames_of_[id];
  }

  FamilyReadings summarised(const std::string& family) const {
    FamilyReadings readings{.family = family, .readings = margins_.size(), .frames = frames_};
    if (margins_.empty()) return readings;
    readings.median_margin = median(margins_);
    for (const auto& [id, frames] : frames_of_)
      readings.frames_of_one_tag = std::max(readings.frames_of_one_tag, frames);
    return readings;
  }

 private:
  std::map<int, std::size_t> frames_of_;
  std::vector<double> margins_;
  std::size_t frames_ = 0;
};

}  // namespace

void FamilySample::offer(const GrayView& image, std::span<const Detection> asked) {
  const bool is_explained =
      std::ranges::any_of(asked, [](const Detection& one) { return one.hamming.value_or(0) == 0; });
  (is_explained ? explained_ : unexplained_).offer(image);
}

std::vector<GrayImage> FamilySample::images() const {
  std::vector<GrayImage> all = unexplained_.images();
  all.insert(all.end(), explained_.images().begin(), explained_.images().end());
  return all;
}

std::optional<OddPictures> find_odd_pictures_of_any(std::span<const GrayImage> images,
                                                    const DetectorOptions& asked) {
  constexpr std::size_t kMost = 2;
  return find_odd_pictures(images.first(std::min(kMost, images.size())), options_for_all(asked));
}

std::vector<FamilyReadings> read_other_families(std::span<const GrayImage> images,
                                                const DetectorOptions& asked, int num_threads,
                                                const ProgressSink& progress, const ShouldStop& should_stop) {
  if (images.empty()) return {};
  const DetectorOptions options = options_for_all(asked);
  const auto threads = static_cast<std::size_t>(resolved(num_threads, images.size()));
  std::vector<std::vector<Detection>> detections(images.size());
  const ProgressStep advance = begin_progress(progress, "try other families", images.size());
  std::mutex mutex;
  parallel_for(static_cast<int>(threads))(threads, [&](std::size_t thread) {
    Detector detector(options);
    for (std::size_t i = thread; i < images.size() && !asks_to_stop(should_stop); i += threads) {
      detections[i] = detector.detect(images[i].view());
      const std::lock_guard lock(mutex);
      advance();
    }
  });
  std::vector<FamilyReadings> all;
  for (const std::string& family : options.families) {
    if (std::ranges::find(asked.families, family) != asked.families.end()) continue;
    ReadingsOfFamily readings;
    for (const std::vector<Detection>& of_image : detections) readings.add(of_image, family);
    all.push_back(readings.summarised(family));
  }
  std::erase_if(all, [](const FamilyReadings& readings) { return readings.readings == 0; });
  return all;
}

}  // namespace apriltrack
