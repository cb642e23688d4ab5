#include "corner_noise.h"

#include <algorithm>
#include <cmath>

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

/// Of the blur: a motion that is not even puts the mean of the exposure beside its middle, by a E^2 / 24. Of
/// a hand that shakes with w = 2 pi 2.5 Hz, that is w E / 24 of the path v E: 0.01 in exposures of 16 ms.
constexpr double kUnevenMotion = 0.01;

/// What detectors claim of the inliers' corners, mean square, and what these err by beyond it; nullopt where
/// one of them does not claim anything.
std::optional<double> claimed_variance_px2(const PoseCandidate& candidate) {
  double sum_px2 = 0.0;
  for (const TagObservation* observation : candidate.inliers) {
    if (!observation->claimed_sigma_px) return std::nullopt;
    sum_px2 += *observation->claimed_sigma_px * *observation->claimed_sigma_px;
  }
  if (candidate.inliers.empty()) return std::nullopt;
  return 2.0 * sum_px2 / static_cast<double>(candidate.inliers.size()) + kBeyondClaim_px * kBeyondClaim_px;
}

}  // namespace

double expected_corner_sigma_px(double sharp_sigma_px, std::optional<double> blur_px,
                                const PoseCandidate& candidate) {
  double mean_square_factor = 0.0;
  for (const TagObservation* observation : candidate.inliers) {
    const double factor = 1.0 + kSigmaPerCorrectedBit * observation->corrected_bits;
    mean_square_factor += factor * factor / static_cast<double>(candidate.inliers.size());
  }
  if (const auto claimed_px2 = claimed_variance_px2(candidate)) {
    const double of_motion_px = kUnevenMotion * blur_px.value_or(0.0);
    return std::sqrt(mean_square_factor * (*claimed_px2 + of_motion_px * of_motion_px));
  }
  return std::sqrt(mean_square_factor) *
         std::hypot(sharp_sigma_px, kDetectedSigmaPerBlur * blur_px.value_or(kUnknownBlur_px));
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

double fitted_corner_sigma_px(double sharp_sigma_px, double expected_sigma_px, const PoseCandidate& candidate,
                              double explained_px2) {
  const double degrees_of_freedom = 2.0 * candidate.num_corners() - 6.0;
  const double variance_px2 = (kPriorStrength * expected_sigma_px * expected_sigma_px +
                               std::max(0.0, candidate.squared_error_px2 - explained_px2)) /
                              (kPriorStrength + degrees_of_freedom);
  return std::max(std::min(sharp_sigma_px, expected_sigma_px), std::sqrt(variance_px2));
}

}  // namespace apriltrack
