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
  constexpr double kSharp_px = 0.03;
  constexpr double kPerBlur = 0.006;
  constexpr double kUsual = 0.004, kLeast = 0.02, kMost = 10.0;
  return std::hypot(kSharp_px, kPerBlur * path_px) *
         std::sqrt(std::clamp(unexplained / kUsual, kLeast, kMost));
}

}  // namespace apriltrack
