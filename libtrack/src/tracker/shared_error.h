#pragma once

#include <cmath>

namespace apriltrack {

/// By how much a tag's corners err together, per axis: response, lens, path, print
/// (docs/algorithms/blur_tracker.md, equation 10).
inline double shared_sigma_px(double path_px) {
  constexpr double kSharp_px = 0.03;
  constexpr double kPerBlur = 0.01;
  return std::hypot(kSharp_px, kPerBlur * path_px);
}

}  // namespace apriltrack
