#pragma once

#include <optional>
#include <vector>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// One tag of both maps, after the alignment.
struct TagDifference {
  TagKey key;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< Estimate minus truth, in the true map's frame.
  double position_m = 0.0;
  double rotation_rad = 0.0;
  double size_difference_m = 0.0;  ///< Estimate minus truth.
  /// xi^T C^-1 xi / 6 of the pose relative to the held tag, without alignment; nullopt for the held tag,
  /// without a covariance, or when not exactly one common tag is held.
  std::optional<double> nees_over_6;
};

struct Distribution {
  double rms = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double max = 0.0;
};

struct MapComparison {
  std::vector<TagDifference> tags;  ///< Common tags by family and id.
  std::vector<TagKey> missing;      ///< Only in the truth.
  std::vector<TagKey> extra;        ///< Only in the estimate.
  Pose T_truth_estimate;            ///< Best rigid motion of the estimate onto the truth, without scale.
  Distribution position_m;
  Distribution rotation_rad;
  std::size_t worst = 0;        ///< Index of the common tag that is farthest off in position.
  std::optional<double> scale;  ///< Spread of the estimate over that of the truth: 1.01 = 1 % too large.
  std::optional<Distribution> nees_over_6;
  std::optional<TagKey> held_tag;  ///< The one common tag that the estimate's gauge holds.
};

/// Throws Error(kNoResult) when the maps share no tag, Error(kInvalidInput) when a covariance has no inverse
/// or a map is not as check_tag_map() wants it.
MapComparison compare_maps(const TagMap& truth, const TagMap& estimate);

}  // namespace apriltrack
