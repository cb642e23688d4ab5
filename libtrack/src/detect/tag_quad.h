#pragma once

#include "edge_frame.h"

namespace apriltrack {

/// The corners in the tag's own coordinates: u right, v down, in half tag sizes.
inline const Quad kTagQuad = {Eigen::Vector2d(-1.0, 1.0), {1.0, 1.0}, {1.0, -1.0}, {-1.0, -1.0}};

}  // namespace apriltrack
