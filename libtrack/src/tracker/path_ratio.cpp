#include "path_ratio.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

constexpr double kMaxSpan_s = 0.3;
constexpr double kMaxUnevenness = 2.1;  // a frame left out: from there on Simpson's weights turn negative
/// Mean path below which the picture's own sharpness tells as much of it as the motion.
constexpr double kMinPath_px = 4.0;
/// Of a path in the picture, each time: what lens and response are off by is the same in all frames, and must
/// not be averaged away. (A lens that blurs by 0.3 px in place of 0.5 makes 3 px seem 2.7, 10 px 9.9.)
constexpr double kPathSigma_px = 1.0;
constexpr double kPathSigmaShare = 0.05;
/// Of the logarithm: beyond it the motion may as well have turned about.
constexpr double kMaxMotionVariance = 0.5;
/// Of the change between two mean velocities, squared, in sigmas: beyond it the poses are not those of one
/// motion, but of a cut film or a false pose.
constexpr double kMaxJump = 25.0;
/// Of a corner's place by a pose, amply.
constexpr double kPoseSigma_px = 0.2;
/// Of the motion noise, which allows for the sharpest turn: ratios scatter by a tenth of what it says in our
/// recordings. Not less, for frames take part in three observations, which are no independent ones.
constexpr double kNoiseShare = 0.5;

double interval_s(const BlurredInstant& from, const BlurredInstant& to) {
  return seconds_between(from.time, to.time);
}

/// Mean velocity from one pose to another, in the frame of `at`.
Vector6d velocity_between(const BlurredInstant& from, const BlurredInstant& to, const Pose& at) {
  Vector6d result;
  result << at.rotation().conjugate() * (to.pose.translation() - from.pose.translation()),
      rotation_log(from.pose.rotation().conjugate() * to.pose.rotation());
  return result / interval_s(from, to);
}

/// The blur's velocity in the frame of `at`; the angular one keeps its axis.
Vector6d velocity_at(const BlurredInstant& frame, const Pose& at) {
  Vector6d result = frame.velocity;
  result.head<3>() = at.rotation().conjugate() * (frame.pose.rotation() * frame.velocity.head<3>());
  return result;
}

Vector6d densities(const MotionNoise& noise) {
  Vector6d result;
  result << Eigen::Vector3d::Constant(noise.linear_m2_per_s3),
      Eigen::Vector3d::Constant(noise.angular_rad2_per_s3);
  return result;
}

/// change: from the mean velocity before the middle frame to the one after. Under white acceleration of
/// density q its variance is q span / 3; to that comes that of the poses, which the middle one is in with
/// both intervals.
bool is_jump(const Vector6d& change, double before_s, double after_s, const BlurredInstant& middle,
             const Vector6d& q) {
  constexpr double kLeastShare = 1e-9;  // of what is seen best
  Matrix6d seen = middle.pixels_by_pose.transpose() * middle.pixels_by_pose / (kPoseSigma_px * kPoseSigma_px);
  seen.diagonal().array() += kLeastShare * seen.diagonal().maxCoeff();
  const double both = 1.0 / before_s + 1.0 / after_s;
  const double by_pose = 1.0 / (before_s * before_s) + 1.0 / (after_s * after_s) + both * both;
  Matrix6d covariance = by_pose * seen.ldlt().solve(Matrix6d::Identity());
  covariance.diagonal() += q * ((before_s + after_s) / 3.0);
  return change.dot(covariance.ldlt().solve(change)) > kMaxJump;
}

}  // namespace

std::optional<PathRatio> path_ratio(const std::array<BlurredInstant, 3>& frames, const MotionNoise& noise) {
  const auto& [first, middle, last] = frames;
  const double before_s = interval_s(first, middle), after_s = interval_s(middle, last);
  if (!(before_s > 0.0 && after_s > 0.0 && before_s + after_s <= kMaxSpan_s)) return std::nullopt;
  const double uneven = std::max(before_s, after_s) / std::min(before_s, after_s);
  if (uneven > kMaxUnevenness || middle.pixels_by_pose.rows() == 0) return std::nullopt;

  const double span_s = before_s + after_s;
  const std::array<double, 3> weights = {(2.0 - after_s / before_s) / 6.0,
                                         span_s * span_s / (6.0 * before_s * after_s),
                                         (2.0 - before_s / after_s) / 6.0};
  const auto& J = middle.pixels_by_pose;
  const std::array<Vector6d, 3> moved = {velocity_between(first, middle, middle.pose),
                                         velocity_between(first, last, middle.pose),
                                         velocity_between(middle, last, middle.pose)};
  const Vector6d q = densities(noise);
  if (is_jump(moved[2] - moved[0], before_s, after_s, middle, q)) return std::nullopt;
  Eigen::VectorXd blurred_px = Eigen::VectorXd::Zero(J.rows());
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::VectorXd path_px = middle.exposure_s * (J * velocity_at(frames[i], middle.pose));
    // A path and its reverse blur alike: of the two, the way that the poses went.
    const double sign = path_px.dot(J * moved[i]) < 0.0 ? -1.0 : 1.0;
    blurred_px += sign * weights[i] * path_px;
  }
  const Eigen::VectorXd moved_px = middle.exposure_s * (J * moved[1]);
  const double points = 0.5 * static_cast<double>(J.rows());
  const double blurred2 = blurred_px.squaredNorm() / points, moved2 = moved_px.squaredNorm() / points;
  if (!(std::max(blurred2, moved2) >= kMinPath_px * kMinPath_px && moved2 > 0.0)) return std::nullopt;

  const Vector6d weight = middle.exposure_s / (points * moved2) * (J.transpose() * moved_px);
  const Vector6d velocity_variance = q * (span_s / 36.0);  // of Simpson's rule, under white acceleration
  const double path_variance = kPathSigma_px * kPathSigma_px + kPathSigmaShare * kPathSigmaShare * blurred2;
  const double motion_variance = kNoiseShare * weight.dot(velocity_variance.cwiseProduct(weight));
  if (motion_variance > kMaxMotionVariance) return std::nullopt;
  return PathRatio{blurred_px.dot(moved_px) / (points * moved2), motion_variance + path_variance / blurred2};
}

}  // namespace apriltrack
