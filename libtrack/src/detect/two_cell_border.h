#pragma once

#include "edge_frame.h"
#include "light_sampler.h"

namespace apriltrack {

/// Whether the square looks more like id of tag36h11b2 than like the same id of tag36h11. The codes are the
/// same, and the library, which compares the code's cells only, takes most tags of the one for the other:
/// cells 10/8 as wide are sampled on the lines between them.
bool has_two_cell_border(const LightSampler& light, int id, const Quad& corners_px);

}  // namespace apriltrack
