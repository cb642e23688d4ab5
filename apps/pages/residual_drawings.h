#pragma once

#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "map_drawings.h"

namespace apriltrack::app {

/// Of each camera that saw tags: the mean residual of the corners by their place in the image. A lens that is
/// not as its file says leaves a pattern there.
MapDrawing draw_residual_maps(const MapEvidence& evidence, const CameraRig& rig);
/// How often residuals of which size are left, against the normal distribution.
MapDrawing draw_residual_histogram(const MapEvidence& evidence);

}  // namespace apriltrack::app
