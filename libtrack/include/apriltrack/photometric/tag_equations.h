#pragma once

#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// What one tag's pixels say about a state, for themselves: Gauss and Newton's equations of their cost, in
/// [left perturbation of the camera's view of the map; of its rate], colours eliminated.
struct TagEquations {
  TagEvidence evidence;
  Matrix12d H = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();
};

/// Of every chosen tag that shows enough of itself.
std::vector<TagEquations> equations_by_tag(PhotometricWorld& world, const PhotometricFrame& frame,
                                           const MotionState& state, const EvidenceOptions& options = {});

}  // namespace apriltrack
