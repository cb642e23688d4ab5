#pragma once

#include <algorithm>
#include <cmath>

namespace apriltrack {

/// By how much a tag's corners err together, per axis, where nothing else is known: response, lens, path,
/// print (docs/algorithms/blur_tracker.md, section 7).
inline double usual_shared_sigma_px(double path_px) {
  constexpr double kSharp_px = 0.03;
  constexpr double kPerBlur = 0.01;
  return std::hypot(kSharp_px, kPerBlur * path_px);
}

/// Where the tag has been fitted: errors that its pixels share leave something that it does not explain.
/// unexplained: that share of the pixels' variance, noise apart (docs/algorithms/blur_tracker.md, equation
/// 10).
inline double shared_sigma_px(double path_px, double unexplained) {
  constexpr double kSharp_px = 0.055;
  constexpr double kPerBlur = 0.003;
  constexpr double kOfRightModel = 0.0005, kUsual = 0.0035;
  const double excess = std::max(0.0, unexplained - kOfRightModel) / kUsual;
  // Below the usual, errors that are shared hide among those that are not; above, the state itself is off.
  const double factor = std::pow(excess, excess < 1.0 ? 0.45 : 0.8);
  constexpr double kLeast = 0.02, kMost = 12.0;
  return std::hypot(kSharp_px, kPerBlur * path_px) * std::clamp(factor, kLeast, kMost);
}

}  // namespace apriltrack
