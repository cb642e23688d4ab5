#pragma once

#include "apriltrack/tags/tag_family.h"

namespace apriltrack {

// How often a detector reads a tag where there is none (docs/algorithms/detector.md, section 2a).

/// Most chance readings in a frame, on average, that a detector's defaults allow a family.
inline constexpr double kMostChanceReadings = 1e-3;

/// Corrected bits up to which a code is believed as read; -1: none, not even a code read without a wrong bit.
int corrected_bits_by_code(const TagFamily& family);
/// The same where the picture must also look like that tag (pattern_correlation()); never fewer.
int corrected_bits_by_picture(const TagFamily& family);

/// Readings with at most `corrected_bits` that a detector's defaults let pass in a frame without such tags,
/// on average.
double chance_readings_per_frame(const TagFamily& family, int corrected_bits);

}  // namespace apriltrack
