#pragma once

#include <array>
#include <memory>
#include <vector>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/sim/sampled_path.h"

namespace apriltrack {

/// amplitude * sin(2 pi frequency_hz t + phase_rad).
struct Wave {
  double amplitude = 0.0;
  double frequency_hz = 0.0;
  double phase_rad = 0.0;
};

/// A jerk of the hand: a wave under a Gaussian window, exp(-(t - centre_s)^2 / (2 width_s^2)).
struct Burst {
  double amplitude = 0.0;
  double centre_s = 0.0;
  double width_s = 0.1;
  double frequency_hz = 0.0;
  double phase_rad = 0.0;
};

/// From one value to another: amplitude * Phi((t - centre_s) / width_s), Phi the normal distribution's
/// integral. A row of steps is a way past given places, which stays within their bounds; a narrow one is a
/// jolt.
struct Step {
  double amplitude = 0.0;
  double centre_s = 0.0;
  double width_s = 0.1;  ///< > 0.
};

/// One coordinate as a smooth (infinitely often differentiable) function of time.
struct Channel {
  double offset = 0.0;
  double rate_per_s = 0.0;
  std::vector<Wave> waves;
  std::vector<Burst> bursts;
  std::vector<Step> steps = {};

  double at(double time_s) const;
  bool is_constant() const;
};

/// A smooth motion that can be asked for its pose at ANY instant, so that truth needs no interpolation.
///
/// T_parent_moving = (position, Rz(yaw) Ry(pitch) Rx(roll)) * T_end, angles in radians. T_end turns the frame
/// that the angles speak of (x ahead, y left, z up) into the frame wanted, such as a camera's.
struct Motion {
  std::array<Channel, 3> position_m;
  Channel yaw_rad;
  Channel pitch_rad;
  Channel roll_rad;
  Pose T_end;
  /// Instead of the channels: T_parent_moving = path * T_end; null: none.
  std::shared_ptr<const SampledPath> path = nullptr;
  double speed = 1.0;  ///< Time runs so many times faster along the same path.

  static Motion fixed(const Pose& pose);
  Pose at(double time_s) const;
  bool is_fixed() const;
};

/// Orientation of a camera (x right, y down, z forward) in a frame with x ahead, y left, z up.
Pose camera_looking_along_x();

}  // namespace apriltrack
