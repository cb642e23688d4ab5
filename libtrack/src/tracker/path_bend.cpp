#include "path_bend.h"

#include <algorithm>
#include <cmath>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

// Against the exact truth of hand-held and thrown recordings at 30 Hz: the change of velocity since the last
// frame is the acceleration times 0.96 to 1.03, off by 0.18 to 0.37 of its length where it is large,
// and by up to this share of what the motion's noise allows where it is small.
constexpr double kRelativeSigma = 0.2;
constexpr double kLeastShareOfNoise = 0.1;
/// Of the motion's noise, where nothing was seen before: what films show all together.
constexpr double kUnknownShareOfNoise = 0.5;
/// In the same recordings with frames left out, the change's share that goes on is 0.82 to 0.93 after 1/15 s,
/// 0.55 to 0.82 after 1/10 s, none after 1/5 s: a bell of this width.
constexpr double kMemory_s = 3.5 / 30.0;
/// Of the motion's noise: a change as great as this is a jump, a false pose or another path, none that goes
/// on. The greatest in those recordings are half of it.
constexpr double kGreatestShareOfNoise = 4.0;

/// Of a change of velocity over interval_s, what is left of it at the end.
double share_that_goes_on(double interval_s) {
  const double past = std::max(0.0, interval_s - kUsualInterval_s) / kMemory_s;
  return std::exp(-past * past);
}

/// Standard deviation of what the noise changes in an acceleration from one frame to the next: white noise of
/// density q changes the velocity by sqrt(q dt) in dt.
double change_by_noise(double density, double interval_s) {
  return std::sqrt(density / std::min(interval_s, kUsualInterval_s));
}

/// Of three numbers alike, along `seen`.
double sigma_of_known(const Eigen::Vector3d& seen, double share, double by_noise) {
  const double length = seen.norm();
  const double greatness = std::min(1.0, length / (kGreatestShareOfNoise * by_noise));
  const double relative = std::hypot(kRelativeSigma, greatness * greatness);
  const double forgotten = kUnknownShareOfNoise * std::sqrt(1.0 - share * share);
  return std::hypot(relative * length, std::hypot(kLeastShareOfNoise, forgotten) * by_noise);
}

}  // namespace

PathBend expected_bend(const Vector6d& velocity, const std::optional<Vector6d>& expected,
                       const std::optional<double>& interval_s, const MotionNoise& noise) {
  APRILTRACK_CHECK(!interval_s || *interval_s > 0.0, "a frame is later than the one before");
  PathBend bend;
  const double linear = change_by_noise(noise.linear_m2_per_s3, interval_s.value_or(kUsualInterval_s));
  const double angular = change_by_noise(noise.angular_rad2_per_s3, interval_s.value_or(kUsualInterval_s));
  if (!expected || !interval_s) {
    bend.sigma.head<3>().setConstant(kUnknownShareOfNoise * linear);
    bend.sigma.tail<3>().setConstant(kUnknownShareOfNoise * angular);
    return bend;
  }
  const double share = share_that_goes_on(*interval_s);
  bend.acceleration = acceleration_per_change(*interval_s) * (velocity - *expected);
  bend.sigma.head<3>().setConstant(sigma_of_known(bend.acceleration.head<3>(), share, linear));
  bend.sigma.tail<3>().setConstant(sigma_of_known(bend.acceleration.tail<3>(), share, angular));
  return bend;
}

double acceleration_per_change(double interval_s) {
  return share_that_goes_on(interval_s) / interval_s;
}

Matrix6d bend_covariance(const Vector6d& sigma, double exposure_s) {
  const double shift_by_acceleration_s2 = exposure_s * exposure_s / 24.0;  // the mean of t^2 / 2
  return (shift_by_acceleration_s2 * sigma).cwiseAbs2().asDiagonal();
}

}  // namespace apriltrack
