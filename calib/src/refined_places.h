#pragma once

#include <string>
#include <vector>

#include "apriltrack/calib/refine_map.h"
#include "refinement_input.h"

namespace apriltrack {

/// What of the scene is refined.
struct RefinedTags {
  const RefinementInput& input;
  std::vector<int> tags;  ///< Sorted.
  int anchor = -1;        ///< The held tag, or another where it has no pictures to be used.

  /// tag: of the scene.
  MapTag& in(TagMap& map, int tag) const;
};

/// Constraints weigh against the pictures of all tags that they name: why not, where one is not `refined`;
/// else empty.
std::string why_constrained_tag_is_needed(const std::vector<TagKey>& refined,
                                          const std::vector<MapConstraint>& constraints);

/// The tags' new poses with covariances, kept to the constraints, and flags by these. Maps too large for
/// covariances (CalibrationOptions::max_tags_with_covariance) stay without. Why not, where the views leave a
/// pose undetermined, or contradict the constraints; else empty. views: linearised at `state`.
std::string take_places(const RefinedTags& refined, const CalibrationResult& calibration,
                        const PhotometricState& state, const std::vector<LinearView>& views,
                        const RefinementOptions& options, RefinementResult& result);

}  // namespace apriltrack
