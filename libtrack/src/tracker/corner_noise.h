#pragma once

#include <optional>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "pose_candidate.h"

namespace apriltrack {

/// Corner noise per axis to expect before the fit: that of sharp corners and a share of the blur, more where
/// bits had to be corrected. Where detectors told covariances, what these claim.
///
/// blur_px: path of a corner during the exposure; nullopt when the motion is not known.
double expected_corner_sigma_px(double sharp_sigma_px, std::optional<double> blur_px,
                                const PoseCandidate& candidate);

/// Path in pixels of the inliers' corners during `exposure_s`, from the motion since `T_camera_map_before`.
std::optional<double> corner_blur_px(const CameraModel& model, const PoseCandidate& candidate,
                                     const Pose& T_camera_map_before, double age_s, double exposure_s);

/// What the expectation and the residuals say together; never below the sharp corners' sigma, or the
/// expectation where that is less.
///
/// The expectation counts as kPriorStrength residuals (a scaled inverse chi-squared prior), so that many tags
/// speak for themselves, while a lone tag, whose eight numbers leave two to judge by, cannot claim more than
/// is known.
///
/// explained_px2: share of the candidate's squared error that is not the corners' fault, but the map's.
double fitted_corner_sigma_px(double sharp_sigma_px, double expected_sigma_px, const PoseCandidate& candidate,
                              double explained_px2 = 0.0);

}  // namespace apriltrack
