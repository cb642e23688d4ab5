#include "apriltrack/detect/patch_keeper.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace apriltrack {
namespace {

/// From so many frames on every second is kept, from twice as many on every fourth, and so on.
constexpr std::size_t kFramesInFull = 400;
constexpr std::size_t kEnoughOfTag = 40;

}  // namespace

bool PatchKeeper::is_wanted(const FrameDetections& frame) const {
  const std::size_t stride = std::bit_ceil(num_kept_ / kFramesInFull + 1);
  if (num_seen_ % stride == 0) return true;
  return std::ranges::any_of(frame.detections, [&](const Detection& one) {
    const auto kept = kept_of_tag_.find(one.tag);
    return kept == kept_of_tag_.end() || kept->second < kEnoughOfTag;
  });
}

void PatchKeeper::keep(const GrayView& image, FrameDetections& frame) {
  if (frame.detections.empty()) return;
  const bool is_kept = is_wanted(frame);
  ++num_seen_;
  if (!is_kept) return;
  ++num_kept_;
  for (const Detection& detection : frame.detections) {
    if (auto patch = cut_patch(image, detection)) {
      frame.patches.push_back(std::move(*patch));
      ++kept_of_tag_[detection.tag];
    }
  }
}

}  // namespace apriltrack
