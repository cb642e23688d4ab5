#pragma once

#include <span>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "photometric/photometric_adjustment.h"

namespace apriltrack {

/// What is refined, and where it begins.
struct RefinementInput {
  PhotometricScene scene;
  PhotometricState start;
  std::vector<int> map_index;  ///< Of each tag of the scene, into the calibration's map.
  int held_tag = -1;           ///< Of the scene; -1 where too few pictures show it.
  int num_moments = 0;
};

/// The pictures of chosen moments that show two tags of the map or more, at the poses of the calibration: of
/// tags that hang together (tags_that_hang_together.h). Tags of the scene may be left without.
RefinementInput refinement_input(const CalibrationResult& calibration,
                                 std::span<const FrameDetections> frames, const CameraRig& rig,
                                 int max_moments, const ParallelFor& parallel);

}  // namespace apriltrack
