#include "apriltrack/sim/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apriltrack {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

}  // namespace

double Channel::at(double time_s) const {
  double value = offset + rate_per_s * time_s;
  for (const Wave& wave : waves) {
    value += wave.amplitude * std::sin(kTwoPi * wave.frequency_hz * time_s + wave.phase_rad);
  }
  for (const Burst& burst : bursts) {
    const double since_s = time_s - burst.centre_s;
    const double window = std::exp(-0.5 * since_s * since_s / (burst.width_s * burst.width_s));
    value += burst.amplitude * window * std::sin(kTwoPi * burst.frequency_hz * since_s + burst.phase_rad);
  }
  for (const Step& step : steps) {
    value +=
        0.5 * step.amplitude * std::erfc((step.centre_s - time_s) / (step.width_s * std::numbers::sqrt2));
  }
  return value;
}

bool Channel::is_constant() const {
  return rate_per_s == 0.0 && waves.empty() && bursts.empty() && steps.empty();
}

Motion Motion::fixed(const Pose& pose) {
  Motion motion;
  motion.T_end = pose;
  return motion;
}

Pose Motion::at(double time_s) const {
  const double t = speed * time_s;
  if (path) return path->at(t) * T_end;
  const Eigen::Vector3d position(position_m[0].at(t), position_m[1].at(t), position_m[2].at(t));
  const Eigen::Quaterniond rotation = about(Eigen::Vector3d::UnitZ(), yaw_rad.at(t)) *
                                      about(Eigen::Vector3d::UnitY(), pitch_rad.at(t)) *
                                      about(Eigen::Vector3d::UnitX(), roll_rad.at(t));
  return Pose(rotation, position) * T_end;
}

bool Motion::is_fixed() const {
  const bool is_constant =
      std::all_of(position_m.begin(), position_m.end(), [](const Channel& c) { return c.is_constant(); }) &&
      yaw_rad.is_constant() && pitch_rad.is_constant() && roll_rad.is_constant();
  return (is_constant && !path) || speed == 0.0;
}

Pose camera_looking_along_x() {
  Eigen::Matrix3d R_body_camera;
  R_body_camera << 0, 0, 1,  //
      -1, 0, 0,              //
      0, -1, 0;
  return {R_body_camera, Eigen::Vector3d::Zero()};
}

}  // namespace apriltrack
