#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// A detected corner of a mapped tag.
struct CornerObservation {
  Eigen::Vector3d point_map;
  Eigen::Vector2d pixel;
  double sigma_px = 0.0;
};

/// How well one tag's picture explains the pixels that it should cover.
struct TagEvidence {
  int tag_index = 0;  ///< Into PhotometricWorld::tags.
  int num_pixels = 0;
  double area_px = 0.0;      ///< Of the image that these pixels stand for.
  double correlation = 0.0;  ///< sqrt of the share of the pixels' variance that the tag explains; 0 for a negative tag.
  double contrast = 0.0;     ///< Light between black and white.
  double path_px = 0.0;      ///< Of the tag's fastest corner during the exposure.
};

struct MotionFit {
  MotionState state;
  /// Of [right perturbation of the pose; change of velocity]: prior, pixels and corners together.
  Matrix12d information = Matrix12d::Zero();
  std::vector<TagEvidence> tags;  ///< Those that show enough of themselves.
};

struct MotionFitOptions {
  int coarsest_level = 2;
  int max_steps_per_level = 8;
  int max_pixels_per_tag = 700;
};

/// Maximises the joint photometric likelihood of all visible tags over pose and velocity, coarse to fine,
/// together with the prior and the detected corners (docs/algorithms/blur_tracker.md).
///
/// start: where the search begins; its acceleration is kept. prior: none when nothing is known; its mean's
/// pose must be of the same mode.
MotionFit fit_motion(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& start,
                     const std::optional<MotionBelief>& prior, const std::vector<CornerObservation>& corners,
                     const MotionFitOptions& options = {});

/// The evidence for a state as it stands, on `level`.
std::vector<TagEvidence> weigh_evidence(PhotometricWorld& world, const PhotometricFrame& frame,
                                        const MotionState& state, int level, int max_pixels_per_tag);

/// Log-likelihood of the evidence against "no tag here": sum over tags of -(n / 2) log(1 - c^2 + kappa), with
/// n = area / 3 independent samples and at most 340 (docs/design: Gaussian noise with unknown gain and offset).
double log_likelihood(const std::vector<TagEvidence>& tags);
/// Mean correlation, each tag weighed by its independent samples; 0 without tags.
double mean_correlation(const std::vector<TagEvidence>& tags);

}  // namespace apriltrack
