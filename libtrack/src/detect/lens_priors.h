#pragma once

// What is known of a lens before a picture is seen, wherever a tag's pattern is fitted: one standard
// deviation each (docs/algorithms/detector.md, Constants).

namespace apriltrack {

inline constexpr double kBlurPrior_px2 =
    0.25;  ///< Variance of the blur of a lens in focus, along either axis.
inline constexpr double kBlurPriorSpread_px2 = 2.0;
/// What a lens displaces a point by that lies r from the middle: 1.2e-4 r^2 (k1 = -0.3, a fifth of the focal
/// length off the axis, f = 500 px: |k1| x / f), and 1.2e-6 r^3 (|k1| / f^2).
inline constexpr double kBendPrior_per_px = 1.2e-4, kBendPrior_per_px2 = 1.2e-6;
/// So much of that is left where a known lens has straightened the picture.
inline constexpr double kBendPriorLeft = 1e-3;

}  // namespace apriltrack
