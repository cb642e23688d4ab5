#pragma once

#include "apriltrack/tags/tag_family.h"
#include "edge_frame.h"
#include "light_sampler.h"

namespace apriltrack {

/// Whether the second ring of cells is black like the first, as a border of two cells is. The library
/// compares the code's cells only, and takes most tags of the same codes with a border of ONE cell for it:
/// their cells are 10/8 as wide, so that it samples on the lines between them. A few cells may be hidden or
/// in a gloss.
bool has_two_cell_border(const LightSampler& light, const TagPattern& pattern, const Quad& corners_px);

}  // namespace apriltrack
