#pragma once

#include <optional>
#include <vector>

#include "explanation.h"
#include "motion_memory.h"

namespace apriltrack {

// What a frame leaves open. found: its explanations, best first, at least one.

/// What the explanation, being right, says of the motion.
MotionBelief belief_of(const PhotometricWorld& world, const Explanation& explanation);

/// Whether a pose is another than the belief's, by more than that knows it.
bool is_another(const MotionBelief& belief, const Pose& pose);

/// Whether another place explains the frame about as well.
bool has_rival(const PhotometricWorld& world, const std::vector<Explanation>& found);

struct SecondPose {
  Pose pose;
  double log_odds = 0.0;  ///< Over the best.
};
/// The likeliest pose that is another than the best's. belief: of the best.
std::optional<SecondPose> second_pose(const MotionBelief& belief, const std::vector<Explanation>& found);

/// The motion found, and the likeliest other one where the next frame may decide for it.
std::vector<MotionHypothesis> motions_left_open(const PhotometricWorld& world, const MotionBelief& belief,
                                                const std::vector<Explanation>& found);

}  // namespace apriltrack
