#include "apriltrack/inspect/recording_summary.h"

#include <algorithm>
#include <map>

#include "apriltrack/detect/chance_readings.h"
#include "apriltrack/eval/statistics.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {

FrameTimes frame_times(std::span<const FrameFacts> frames) {
  constexpr double kGapFactor = 2.5;
  std::vector<double> intervals_s;
  FrameTimes times;
  const FrameFacts* before = nullptr;
  for (const FrameFacts& frame : frames) {
    if (frame.is_copy) continue;  // whose time is no picture's
    if (before != nullptr) {
      intervals_s.push_back(seconds_between(before->time, frame.time));
      times.not_forward += intervals_s.back() <= 0.0;
    }
    before = &frame;
  }
  if (intervals_s.empty()) return times;
  const double usual_s = median(intervals_s);
  if (usual_s > 0.0) times.rate_hz = 1.0 / usual_s;
  for (const double interval_s : intervals_s) {
    if (interval_s <= kGapFactor * usual_s) continue;
    ++times.gaps;
    times.longest_gap_s = std::max(times.longest_gap_s, interval_s);
  }
  return times;
}

std::vector<ImageSizeCount> image_sizes(std::span<const FrameFacts> frames) {
  std::map<std::pair<int, int>, std::size_t> counts;
  for (const FrameFacts& frame : frames) ++counts[{frame.width, frame.height}];
  std::vector<ImageSizeCount> sizes;
  for (const auto& [size, count] : counts) sizes.push_back({size.first, size.second, count});
  std::ranges::stable_sort(sizes, std::ranges::greater(), &ImageSizeCount::frames);
  return sizes;
}

bool is_surely_there(const FamilyReadings& readings, std::size_t sampled) {
  const double by_chance = chance_readings_per_frame(TagFamily::get(readings.family), 0);
  constexpr double kHardlyEver = 0.01;
  if (static_cast<double>(sampled) * by_chance < kHardlyEver) return readings.readings > 0;
  // Chance scatters over the ids, and what it reads has little contrast; a tag comes back.
  constexpr std::size_t kFewestFrames = 3;
  constexpr double kLeastMargin = 20.0;  // grey levels
  return readings.frames_of_one_tag >= std::max(kFewestFrames, sampled / 4) &&
         readings.median_margin >= kLeastMargin;
}

std::optional<double> blur_of_frame_px(const FrameFacts& frame) {
  std::vector<double> blurs_px;
  for (const SeenTag& seen : frame.tags)
    if (seen.blur_px) blurs_px.push_back(*seen.blur_px);
  if (blurs_px.empty()) return std::nullopt;
  return median(blurs_px);
}

BlurCounts count_blur(std::span<const FrameFacts> frames) {
  BlurCounts counts;
  std::vector<double> blurs_px;
  std::size_t since_tag = 0;
  bool has_begun = false;
  for (const FrameFacts& frame : frames) {
    if (frame.tags.empty()) {
      ++since_tag;
      continue;
    }
    if (has_begun) counts.unread += since_tag;
    has_begun = true;
    since_tag = 0;
    const auto blur_px = blur_of_frame_px(frame);
    if (!blur_px) continue;
    blurs_px.push_back(*blur_px);
    (*blur_px < kSharpBelow_px    ? counts.sharp
     : *blur_px < kBlurredFrom_px ? counts.soft
                                  : counts.blurred) += 1;
  }
  if (!blurs_px.empty()) {
    counts.median_px = median(blurs_px);
    counts.worst_px = *std::ranges::max_element(blurs_px);
  }
  return counts;
}

}  // namespace apriltrack
