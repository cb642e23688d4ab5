#pragma once

#include <string_view>
#include <vector>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// What is possible of a map, but mostly a mistake of units: millimetres, inches or centimetres for metres.
enum class MapOddityKind {
  kHugeTags,         ///< Edges of over 2 m; `value`: the longest, in metres.
  kOverlappingTags,  ///< Two tags of like size in one place; `value`: how far apart they are, in metres.
  kOutsideField,     ///< Over 1 m beyond the field that the layout states; `value`: the most, in metres.
  kFarApart,  ///< Half of the tags are over 1000 edges from their nearest; `value`: the median, in metres.
};

struct MapOddity {
  MapOddityKind kind = MapOddityKind::kHugeTags;
  std::vector<TagKey> tags;  ///< Those concerned; of overlapping tags two.
  double value = 0.0;
};

/// One of each kind at most, of overlapping tags the first two. Time: as sorting, for tags that do not crowd.
std::vector<MapOddity> oddities_of(const TagMap& map);

/// "huge_tags", "overlapping_tags", "outside_field", "far_apart".
std::string_view to_string(MapOddityKind kind);

}  // namespace apriltrack
