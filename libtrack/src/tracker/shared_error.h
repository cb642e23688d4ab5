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
  constexpr double kSharp_px = 0.08;
  constexpr double kPerBlur = 0.003;
  constexpr double kUsual = 0.004;
  constexpr double kGuessed = 0.02;
  constexpr double kLeast_px = 0.006;  // no lens is known better, however well its picture fits
  constexpr double kMost = 12.0;       // where a tenth is unexplained: worse fits tell no more
  const double ratio = std::max(0.0, unexplained) / kUsual;
  // A seventh of the usual and less is what the guess of the noise leaves, and tells of no shared error.
  const double share = ratio * ratio / (ratio * ratio + kGuessed);
  const double factor = std::min(kMost, share * std::pow(ratio, 0.75));
  return std::hypot(kLeast_px, std::hypot(kSharp_px, kPerBlur * path_px) * factor);
}

/// Of a corner of a lone tag, per axis, where something may cover a strip of it: two of the eight coordinates
/// move by the share that is covered, of its size, and about that share stays unexplained. Below the ramp
/// shared_sigma_px() alone is honest (docs/algorithms/blur_tracker.md, equation 10a).
inline double cover_sigma_px(double size_px, double unexplained) {
  constexpr double kNone = 0.03, kSurely = 0.06;
  return 0.5 * unexplained * size_px * std::clamp((unexplained - kNone) / (kSurely - kNone), 0.0, 1.0);
}

}  // namespace apriltrack
