#pragma once

#include <numbers>

namespace apriltrack {

/// The library reckons in radians; people read degrees, and some bounds are told in them.
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace apriltrack
