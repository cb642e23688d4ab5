#pragma once

#include <optional>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/geometry/pose.h"
#include "pose_candidate.h"

namespace apriltrack {

/// Covariance of corner errors to expect while camera and tag are at rest: what the detector gives for them,
/// with what it cannot see; sharp_sigma_px per axis where it gives nothing, and more where bits had to be
/// corrected.
CornerCovariance still_corner_covariance_px2(const Detection& detection, double sharp_sigma_px);

/// Expected corner noise of the inliers, before the fit, over that of TagObservation::covariance_px2: 1 at
/// rest, more where corners are blurred.
///
/// sharp_sigma_px: of corners without a covariance. blur_px: path of a corner during the exposure, nullopt
/// when the motion is not known; detectors that give covariances count blur in these.
double expected_noise_scale(double sharp_sigma_px, std::optional<double> blur_px,
                            const PoseCandidate& candidate);

/// Path in pixels of the inliers' corners during `exposure_s`, from the motion since `T_camera_map_before`.
std::optional<double> corner_blur_px(const CameraModel& model, const PoseCandidate& candidate,
                                     const Pose& T_camera_map_before, double age_s, double exposure_s);

/// Of T_camera_map: what an acceleration during the exposure adds. It moves all corners of the image
/// together, so that no residual shows it and no number of tags averages it. Of the acceleration that the
/// pose shows over T_camera_map_predicted, which goes on from T_camera_map_before with constant velocity, and
/// of a hand's shake.
Matrix6d uneven_motion_covariance(const Pose& T_camera_map, const Pose& T_camera_map_before,
                                  const Pose& T_camera_map_predicted, double age_s, double exposure_s);

/// What the expectation and the residuals say together, in the same unit; never below what the detectors
/// give, or sharp_sigma_px where they give nothing.
///
/// The expectation counts as kPriorStrength residuals (a scaled inverse chi-squared prior), so that many tags
/// speak for themselves, while a lone tag, whose eight numbers leave two to judge by, cannot claim more than
/// is known.
///
/// explained_error2: share of the candidate's squared error that is not the corners' fault, but the map's.
double fitted_noise_scale(double sharp_sigma_px, double expected_scale, const PoseCandidate& candidate,
                          double explained_error2 = 0.0);

}  // namespace apriltrack
