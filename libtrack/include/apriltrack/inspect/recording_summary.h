#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "apriltrack/inspect/recording_facts.h"

namespace apriltrack {

/// How the frames follow each other in time; copies of frames do not count.
struct FrameTimes {
  std::optional<double> rate_hz = std::nullopt;  ///< By the median interval; none of fewer than two frames.
  std::size_t gaps = 0;                          ///< Intervals of more than 2.5 times the median.
  double longest_gap_s = 0.0;                    ///< 0 without gaps.
  std::size_t not_forward = 0;                   ///< Frames that are no later than the one before.
};
/// frames: of one recording, in its order.
FrameTimes frame_times(std::span<const FrameFacts> frames);

/// The number of readable images of one size, in pixels.
struct ImageSizeCount {
  int width = 0;
  int height = 0;
  std::size_t frames = 0;
};
/// The commonest size first.
std::vector<ImageSizeCount> image_sizes(std::span<const FrameFacts> frames);

/// False if chance explains the readings: families with few bits are read into any pattern, unless one id
/// comes back in frame after frame with a clear margin. sampled: the number of frames that were looked at.
bool is_surely_there(const FamilyReadings& readings, std::size_t sampled);

/// A frame's motion blur in pixels: the median over its tags; nullopt where none could be measured.
std::optional<double> blur_of_frame_px(const FrameFacts& frame);

/// The number of frames with tags, by blur.
struct BlurCounts {
  std::size_t sharp = 0;    ///< Below kSharpBelow_px.
  std::size_t soft = 0;     ///< To kBlurredFrom_px.
  std::size_t blurred = 0;  ///< From kBlurredFrom_px.
  std::size_t unread = 0;   ///< Frames without a tag, between frames with: blurred, or looking elsewhere.
  std::optional<double> median_px = std::nullopt;
  std::optional<double> worst_px = std::nullopt;

  std::size_t measured() const { return sharp + soft + blurred; }
};

/// Bounds of these classes, in pixels of motion during the exposure; an evaluation uses the same.
inline constexpr double kSharpBelow_px = 2.0;
inline constexpr double kBlurredFrom_px = 5.0;

BlurCounts count_blur(std::span<const FrameFacts> frames);

}  // namespace apriltrack
