#pragma once

#include "apriltrack/tags/tag_family.h"
#include "edge_frame.h"
#include "light_sampler.h"

namespace apriltrack {

/// Tags in uneven light, blurred or small, correlate by more than this; 1 of 1708 other squares does
/// (docs/algorithms/detector.md, section 2a).
inline constexpr double kLeastPatternCorrelation = 0.9;

/// How much the square at `corners_px` looks like the tag: the multiple correlation, in [0, 1], of its linear
/// light with
///
///     light(u, v) = l0 + lu u + lv v + (c0 + cu u + cv v) * P(u, v),
///
/// P the pattern under whichever of a few blurs along u and v explains it best. So light that changes over
/// the tag costs nothing. It returns at once when `enough` is reached. 0 where the image cuts the square, or
/// its contrast is reversed.
double pattern_correlation(const LightSampler& light, const TagPattern& pattern, bool is_white_inside,
                           const Quad& corners_px, double enough = 1.0);

}  // namespace apriltrack
