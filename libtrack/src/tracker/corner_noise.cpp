#include "corner_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apriltrack {
namespace {

// Measured against exact truth on path-traced recordings (1007 detections, 0 to 38 px of blur, the detector's
// blurred-edge fits): 0.08 px when sharp, and 0.02 of the blur, with heavy tails; with one corrected bit 2 to
// 4 times as much, with two up to 9 times: bits are lost to occlusion, which moves corners too.
constexpr double kDetectedSigmaPerBlur = 0.025;
constexpr double kSigmaPerCorrectedBit = 3.0;
constexpr double kUnknownBlur_px = 10.0;  // what most of the frames that follow a gap have
constexpr double kPriorStrength = 3.0;

/// Light that is uneven over a tag moves its corners as much again as a detector claims, and in all of its
/// views (docs/algorithms/detector.md, section 5); lens and paper add this much.
constexpr double kBeyondClaim_px = 0.02;

/// An acceleration a puts the mean of the exposure E beside its middle, by a E^2 / 24. Of a hand that shakes
/// with the angular frequency w, that is w E / 24 of the path v E. w: of 2.5 Hz, an assumption.
constexpr double kShake_rad_s = 2.0 * std::numbers::pi * 2.5;

/// What detectors give, or that of sharp corners: no fit shows that corners are better.
CornerCovariance least_covariance_px2(const TagObservation& observation, double sharp_sigma_px) {
  return observation.claimed_covariance_px2.value_or(sharp_sigma_px * sharp_sigma_px *
                                                     CornerCovariance::Identity());
}

/// Mean square of the whitened errors that corners of this covariance have.
double whitened_variance(const TagObservation& observation, const CornerCovariance& covariance_px2) {
  const CornerCovariance& W = observation.whitening_per_px;
  return (W * covariance_px2 * W).trace() / (2.0 * kNumCorners);
}

}  // namespace

CornerCovariance still_corner_covariance_px2(const Detection& detection, double sharp_sigma_px) {
  if (detection.covariance_px2)
    return 2.0 * *detection.covariance_px2 + kBeyondClaim_px * kBeyondClaim_px * CornerCovariance::Identity();
  const double sigma_px = sharp_sigma_px * (1.0 + kSigmaPerCorrectedBit * detection.hamming.value_or(0));
  return sigma_px * sigma_px * CornerCovariance::Identity();
}

double expected_noise_scale(double sharp_sigma_px, std::optional<double> blur_px,
                            const PoseCandidate& candidate) {
  const double blurred = kDetectedSigmaPerBlur * blur_px.value_or(kUnknownBlur_px) / sharp_sigma_px;
  double sum = 0.0;
  for (const TagObservation* observation : candidate.inliers)
    sum += observation->claimed_covariance_px2 ? 1.0 : 1.0 + blurred * blurred;
  return std::sqrt(sum / static_cast<double>(candidate.inliers.size()));
}

std::optional<double> corner_blur_px(const CameraModel& model, const PoseCandidate& candidate,
                                     const Pose& T_camera_map_before, double age_s, double exposure_s) {
  double sum_px2 = 0.0;
  int count = 0;
  for (const TagObservation* observation : candidate.inliers) {
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const auto before = model.project(T_camera_map_before * observation->corners_map[i]);
      const auto now = model.project(candidate.T_camera_map * observation->corners_map[i]);
      if (!before || !now) continue;
      sum_px2 += (*now - *before).squaredNorm();
      ++count;
    }
  }
  if (count == 0 || !(age_s > 0.0)) return std::nullopt;
  return std::sqrt(sum_px2 / count) * exposure_s / age_s;
}

Matrix6d uneven_motion_covariance(const Pose& T_camera_map, const Pose& T_camera_map_before,
                                  const Pose& T_camera_map_predicted, double age_s, double exposure_s) {
  if (!(age_s > 0.0)) return Matrix6d::Zero();
  const double exposed_share = exposure_s / age_s;
  const Vector6d of_shake =
      kShake_rad_s * exposure_s / 24.0 * exposed_share * (T_camera_map_before.inverse() * T_camera_map).log();
  const Vector6d of_acceleration =
      exposed_share * exposed_share / 24.0 * (T_camera_map_predicted.inverse() * T_camera_map).log();
  return of_shake * of_shake.transpose() + of_acceleration * of_acceleration.transpose();
}

double fitted_noise_scale(double sharp_sigma_px, double expected_scale, const PoseCandidate& candidate,
                          double explained_error2) {
  double least_variance = 0.0;
  for (const TagObservation* observation : candidate.inliers)
    least_variance += whitened_variance(*observation, least_covariance_px2(*observation, sharp_sigma_px)) /
                      static_cast<double>(candidate.inliers.size());
  const double degrees_of_freedom = 2.0 * candidate.num_corners() - 6.0;
  const double variance = (kPriorStrength * expected_scale * expected_scale +
                           std::max(0.0, candidate.squared_error - explained_error2)) /
                          (kPriorStrength + degrees_of_freedom);
  return std::sqrt(std::max(least_variance, variance));
}

}  // namespace apriltrack
