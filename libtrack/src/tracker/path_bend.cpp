#include "path_bend.h"

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

/// Of three numbers alike.
void set_sigma(const Eigen::Vector3d& seen, double least, Eigen::Ref<Eigen::Vector3d> sigma) {
  sigma.setConstant(std::hypot(kRelativeSigma * seen.norm(), least));
}

}  // namespace

PathBend expected_bend(const Vector6d& velocity, const std::optional<Vector6d>& expected,
                       const std::optional<double>& interval_s, const MotionNoise& noise) {
  APRILTRACK_CHECK(!interval_s || *interval_s > 0.0, "a frame is later than the one before");
  const bool is_known = expected && interval_s;
  const double dt_s = interval_s.value_or(kUsualInterval_s);
  const double share = is_known ? kLeastShareOfNoise : kUnknownShareOfNoise;
  PathBend bend;
  if (is_known) bend.acceleration = acceleration_per_change(dt_s) * (velocity - *expected);
  // White noise of density q changes the velocity by sqrt(q dt) in dt.
  set_sigma(bend.acceleration.head<3>(), share * std::sqrt(noise.linear_m2_per_s3 / dt_s),
            bend.sigma.head<3>());
  set_sigma(bend.acceleration.tail<3>(), share * std::sqrt(noise.angular_rad2_per_s3 / dt_s),
            bend.sigma.tail<3>());
  return bend;
}

Matrix6d bend_covariance(const Vector6d& sigma, double exposure_s) {
  const double shift_by_acceleration_s2 = exposure_s * exposure_s / 24.0;  // the mean of t^2 / 2
  return (shift_by_acceleration_s2 * sigma).cwiseAbs2().asDiagonal();
}

}  // namespace apriltrack
