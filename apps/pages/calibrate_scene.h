#pragma once

#include <string>

#include "apriltrack/report/scene_view.h"
#include "map_drawings.h"

namespace apriltrack::app {

/// The map in space with the camera's path.
SceneView scene_of_calibration(const DrawnMap& drawn);
/// What is to be seen in it.
std::string caption_of_scene(const DrawnMap& drawn);

}  // namespace apriltrack::app
