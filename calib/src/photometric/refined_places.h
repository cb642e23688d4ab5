#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/calib/refinement_result.h"
#include "apriltrack/tags/tag_map.h"
#include "constraints/constrained_map.h"
#include "photometric/refinement_input.h"

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
/// pose undetermined, or contradict the constraints; else empty. views: linearised at `state`. notes: of the
/// constraints, where the map keeps to some.
std::string take_places(const RefinedTags& refined, const CalibrationResult& calibration,
                        const PhotometricState& state, const std::vector<LinearView>& views,
                        const RefinementOptions& options, RefinementResult& result,
                        std::optional<ConstraintNotes>& notes);

}  // namespace apriltrack
