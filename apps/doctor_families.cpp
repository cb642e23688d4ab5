#include "doctor_families.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "apriltrack/base/parallel.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack::app {
namespace {

/// Beside the families asked for, lest their tags be taken for another's. One search in the image as it is
/// will do, and codes with a corrected bit prove nothing.
DetectorOptions options_for(const std::string& family, const DetectorOptions& asked) {
  DetectorOptions options = asked;
  options.families.push_back(family);
  options.response = ResponseCurve::linear();
  options.max_hamming = 0;
  return options;
}

FamilyReadings read_family(const std::string& family, std::span<const GrayImage> images,
                           const DetectorOptions& asked) {
  Detector detector(options_for(family, asked));
  FamilyReadings readings{.family = family};
  std::map<int, std::size_t> frames_of;
  std::vector<double> margins;
  for (const GrayImage& image : images) {
    if (is_interrupted()) break;
    std::set<int> ids;
    for (const Detection& detection : detector.detect(image.view())) {
      if (detection.tag.family != family) continue;
      ids.insert(detection.tag.id);
      margins.push_back(detection.decision_margin.value_or(0.0));
    }
    readings.frames += !ids.empty();
    for (const int id : ids) ++frames_of[id];
  }
  readings.readings = margins.size();
  if (margins.empty()) return readings;
  readings.median_margin = median(margins);
  for (const auto& [id, frames] : frames_of)
    readings.frames_of_one_tag = std::max(readings.frames_of_one_tag, frames);
  return readings;
}

}  // namespace

std::vector<FamilyReadings> read_other_families(std::span<const GrayImage> images,
                                                const DetectorOptions& asked, int num_threads,
                                                const Console& console) {
  std::vector<std::string> families;
  for (const std::string_view name : TagFamily::names())
    if (std::ranges::find(asked.families, name) == asked.families.end()) families.emplace_back(name);
  if (images.empty()) return {};
  // Decoding tables of a family take up to 400 MB: two at once are enough.
  constexpr int kMostAtOnce = 2;
  const int threads = num_threads == 0 ? kMostAtOnce : std::min(num_threads, kMostAtOnce);
  std::vector<FamilyReadings> all(families.size());
  Progress progress(console, "try other families", families.size());
  std::mutex mutex;
  parallel_for(threads)(families.size(), [&](std::size_t i) {
    if (is_interrupted()) return;
    all[i] = read_family(families[i], images, asked);
    const std::lock_guard lock(mutex);
    progress.advance();
  });
  std::erase_if(all, [](const FamilyReadings& readings) { return readings.readings == 0; });
  return all;
}

}  // namespace apriltrack::app
