#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/calib/map_constraints.h"
#include "constraints/constraint_audit.h"
#include "uncertainty/covariance_operator.h"
#include "uncertainty/joint_change.h"

namespace apriltrack {

/// What the images alone say.
struct ImageMap {
  std::vector<TagKey> keys;  ///< Of all tags, by number.
  std::vector<int> tags;     ///< Those of the map.
  int held_tag = 0;
  std::vector<Pose> T_held_tag;          ///< By number.
  std::vector<Matrix6d> covariances;     ///< Of `tags`, relative to the held tag.
  std::vector<std::string> doubts = {};  ///< In words: of what it may be folded at, and break constraints.
};

/// What the user should know of the constraints, in words.
struct ConstraintNotes {
  std::vector<std::string> not_measured;  ///< The map's frame is not, though constraints were to fix it.
  std::vector<std::string> unused;        ///< Which, and why.
  std::vector<std::string> in_doubt;      ///< Which are used, and disagree with all else.
};

/// The same with constraints.
struct ConstrainedMap {
  Pose T_map_held;              ///< Where the held tag was measured to be; identity where nothing tells.
  std::vector<Pose> T_map_tag;  ///< By number; of tags outside the map untouched.
  std::vector<Matrix6d> covariances;  ///< Of ImageMap::tags, in the map's frame.
  JointChange change;
  std::vector<ConstraintAudit> audits;
  std::string gauge;  ///< How the frame was fixed, in words; empty: by the held tag.
  ConstraintNotes notes;
  bool is_vertical_measured = false;  ///< z of the map's frame is up by what was measured.
};

/// Constraints whose tags are named by family and id, in the numbers of `keys`; `unused` gets the others,
/// with the reason.
std::vector<BoundConstraint> bind_constraints(std::span<const MapConstraint> constraints, const ImageMap& map,
                                              std::vector<std::pair<std::size_t, ConstraintAudit>>& unused);

/// Adds what was measured to what the images say. Throws Error(kNoResult), which names them, where
/// constraints contradict each other or the images; and where two different frames agree with them. joint: of
/// all tags of the map.
ConstrainedMap constrain_map(std::span<const MapConstraint> constraints, const ImageMap& map,
                             const CovarianceOperator& joint);

}  // namespace apriltrack
