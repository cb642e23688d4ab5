#pragma once

#include "apriltrack/image/image.h"

namespace apriltrack {

/// Grey levels by which neighbouring pixels differ, at the least, where a tag's border runs that is read with
/// `min_decision_margin` (docs/algorithms/detector.md, equation 2a). Grain alone differs by less, and is not
/// searched for edges.
int least_contrast(const GrayView& image, double min_decision_margin);

}  // namespace apriltrack
