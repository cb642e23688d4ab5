#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "apriltrack/inspect/recording_facts.h"

namespace apriltrack {

/// How one tag was seen in all recordings.
struct TagSummary {
  TagKey tag;
  std::size_t frames = 0;           ///< Frames that show it.
  std::size_t places_together = 0;  ///< Viewpoints from which it was seen together with another tag.
  std::size_t frames_twice = 0;     ///< Frames that show its id more than once.
  std::size_t views_at_border = 0;  ///< Readings at the border of the image.
  std::size_t views = 0;            ///< Readings.
  double median_edge_px = 0.0;      ///< Of its views, as the next two: length of its edges.
  double smallest_edge_px = 0.0;
  double largest_edge_px = 0.0;
  double median_margin = 0.0;  ///< Decision margin, grey levels.
  std::optional<double> median_blur_px = std::nullopt;
};

/// One for each tag that was seen in usable frames (is_usable()), in the order of their keys.
std::vector<TagSummary> summarise_tags(const InspectionFacts& facts);

/// Connected components of the tags, joined where one viewpoint shows them together: largest first, then by
/// their first tag. A tag that is never seen with another is a component of its own.
std::vector<std::vector<TagKey>> joined_parts(std::span<const std::vector<TagKey>> places);

}  // namespace apriltrack
