#pragma once

#include <vector>

#include "apriltrack/tags/tag_map.h"
#include "calibrate_run.h"

namespace apriltrack::app {

/// The tags that are in no map, each at the place that most of its views give it, for the camera's pose is
/// known from the others. Those that were never seen together with tags of the map are not among them.
std::vector<MapTag> place_left_out_tags(const CalibrateRun& run);

}  // namespace apriltrack::app
