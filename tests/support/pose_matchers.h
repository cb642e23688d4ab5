#pragma once

#include <gmock/gmock.h>

#include <numbers>

#include "apriltrack/geometry/pose.h"

namespace apriltrack::test {

/// Position and orientation judged apart; a mismatch is told in millimetres and degrees.
MATCHER_P3(PoseNear, expected, max_translation_error_m, max_rotation_error_rad, "") {
  const Pose difference = expected.inverse() * arg;
  const double translation_error_m = difference.translation().norm();
  const double rotation_error_rad = rotation_angle_rad(expected.rotation(), arg.rotation());
  *result_listener << "off by " << translation_error_m * 1e3 << " mm and "
                   << rotation_error_rad * 180.0 / std::numbers::pi << " deg";
  return translation_error_m <= max_translation_error_m && rotation_error_rad <= max_rotation_error_rad;
}

}  // namespace apriltrack::test
