#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// A detected corner of a mapped tag.
struct CornerObservation {
  Eigen::Vector3d point_map;
  Eigen::Vector2d pixel;
  double sigma_px = 0.0;
};

struct MotionFit {
  MotionState state;
  /// Of [right perturbation of the pose; change of velocity]: prior, corners and the pixels of the tags
  /// that are explained (of all, where none is).
  Matrix12d information = Matrix12d::Zero();
  std::vector<TagEvidence> tags;  ///< Those that show enough of themselves.
};

struct MotionFitOptions {
  int coarsest_level = 2;
  int max_steps_per_level = 8;
  int max_pixels_per_tag = 700;  ///< As EvidenceOptions'.
};

/// Maximises the joint photometric likelihood of all visible tags over pose and velocity, coarse to fine,
/// together with the prior and the detected corners (docs/algorithms/blur_tracker.md).
///
/// start: where the search begins; its acceleration is kept. prior: none when nothing is known; its mean's
/// pose must be of the same mode.
MotionFit fit_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                     const std::optional<MotionBelief>& prior, const std::vector<CornerObservation>& corners,
                     const MotionFitOptions& options = {});

}  // namespace apriltrack
