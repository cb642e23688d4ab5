#pragma once

#include <numbers>

namespace apriltrack::app {

/// The library speaks in radians, the program to people in degrees.
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;

}  // namespace apriltrack::app
