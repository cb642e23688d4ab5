#pragma once

#include <vector>

#include "apriltrack/report/scene_view.h"
#include "calibrate_report.h"
#include "map_drawings.h"

namespace apriltrack::app {

/// The tags that are in no map, each at the place that most of its views give it, for the camera's pose is
/// known from the others. Those that were never seen together with tags of the map are not among them.
std::vector<MapTag> place_left_out_tags(const CalibrateRun& run);

/// The map in space with the camera's path.
SceneView scene_of_calibration(const DrawnMap& drawn);
/// What is to be seen in it.
std::string caption_of_scene(const DrawnMap& drawn);

}  // namespace apriltrack::app
