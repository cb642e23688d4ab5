#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/photometric/tag_equations.h"

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
  std::vector<TagEvidence> tags;        ///< Those that show enough of themselves.
  std::vector<TagEquations> equations;  ///< What each of them adds to the information, at the state.
};

struct MotionFitOptions {
  int coarsest_level = 2;
  int finest_level = 0;
  int max_steps_per_level = 8;
  /// While the state moves, as EvidenceOptions'.
  int max_pixels_per_tag = 350;
  /// Widespread, of a level that is worth the next finer one: what explains nothing coarsely is not refined.
  double least_correlation = 0.0;
  /// Acceleration within the exposure per change of velocity, 1/s; on the finest level, and only where the
  /// path is not better without it.
  double acceleration_per_change = 0.0;
  Vector6d velocity_before = Vector6d::Zero();  ///< What the velocity has changed from, in the state's frame.
  double extra_sigma_px = 0.0;  ///< Further blur of the tags' pictures, pixels of level 0: a wider basin.
};

/// Maximises the joint photometric likelihood of all visible tags over pose and velocity, coarse to fine,
/// together with the prior and the detected corners (docs/algorithms/blur_tracker.md).
///
/// start: where the search begins; its acceleration is kept, unless the options tell another. prior: none
/// when nothing is known; its mean's pose must be of the same mode.
///
/// At the end one step more, and the evidence, with the pixels that EvidenceOptions asks for.
MotionFit fit_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                     const std::optional<MotionBelief>& prior, const std::vector<CornerObservation>& corners,
                     const MotionFitOptions& options = {});

/// The state alone, where the fit is but a step of a search.
MotionState descend_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                           const std::optional<MotionBelief>& prior, const MotionFitOptions& options);

}  // namespace apriltrack
