#pragma once

#include <numbers>
#include <vector>

#include "apriltrack/eval/compare_maps.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

struct AlignedMap {
  TagMap
      map;  ///< In the reference's frame. Covariances stand as they were: they speak of the tags' own frames.
  Pose T_reference_map;
  int common_tags = 0;
  MapComparison fit;  ///< How the common tags lie to each other afterwards.
};

/// Moves a map by the rigid motion that brings its tags nearest to the same tags of `reference`.
/// Throws what compare_maps() throws.
AlignedMap align_map(const TagMap& reference, const TagMap& map);

struct MergeOptions {
  /// Common tags that differ by more than one of these are conflicts.
  double max_position_difference_m = 0.01;
  double max_rotation_difference_rad = 2.0 * std::numbers::pi / 180.0;

  void check() const;
};

/// A tag on which two maps disagree after alignment: it moved, or one of the maps is wrong.
struct MapConflict {
  TagKey key;
  double position_m = 0.0;
  double rotation_rad = 0.0;
};

struct MergedMap {
  TagMap map;  ///< All tags of `base` as they are, then the others of `addition`.
  Pose T_base_addition;
  int common_tags = 0;
  std::vector<TagKey> added;
  std::vector<MapConflict> conflicts;
  /// Added tags that lost their covariance: it is relative to another gauge than that of `base`.
  std::vector<TagKey> without_covariance;
};

/// Throws what compare_maps() throws, and Error(kInvalidInput) when a common tag has two sizes.
MergedMap merge_maps(const TagMap& base, const TagMap& addition, const MergeOptions& options = {});

}  // namespace apriltrack
