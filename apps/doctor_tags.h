#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "doctor_facts.h"

namespace apriltrack::app {

/// How one tag was seen in all recordings.
struct TagSummary {
  TagKey tag;
  std::size_t frames = 0;           ///< That show it.
  std::size_t places_together = 0;  ///< From which it was seen, and another tag, too.
  std::size_t frames_twice = 0;     ///< That show it more than once.
  std::size_t views_at_border = 0;
  std::size_t views = 0;
  double median_edge_px = 0.0;
  double smallest_edge_px = 0.0;
  double largest_edge_px = 0.0;
  double median_margin = 0.0;
  std::optional<double> median_blur_px = std::nullopt;
};

/// One for every tag that was seen in frames that calibrate uses, in the order of their keys.
std::vector<TagSummary> summarise_tags(const Facts& facts);

/// The parts that places with two or more tags join: largest first, then by their first tag; a tag that is
/// never seen with another is a part of its own.
std::vector<std::vector<TagKey>> joined_parts(std::span<const std::vector<TagKey>> places);

/// A frame's blur: the median over its tags; nullopt where none could be measured.
std::optional<double> blur_of_frame_px(const FrameFacts& frame);

/// A recording's frames by blur.
struct BlurCounts {
  std::size_t sharp = 0;    ///< Below kSharp_px.
  std::size_t soft = 0;     ///< To kBlurred_px.
  std::size_t blurred = 0;  ///< From kBlurred_px.
  std::size_t unread = 0;   ///< Frames without a tag, between frames with: blurred, or looking elsewhere.
  std::optional<double> median_px = std::nullopt;
  std::optional<double> worst_px = std::nullopt;

  std::size_t measured() const { return sharp + soft + blurred; }
};

/// The classes in which `evaluate` counts blur, too.
inline constexpr double kSharp_px = 2.0;
inline constexpr double kBlurred_px = 5.0;

BlurCounts count_blur(std::span<const FrameFacts> frames);

}  // namespace apriltrack::app
