#pragma once

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// `options` for the tags of a map seen by a camera: with the map's families, in its order of first use, and
/// the camera's response. Throws Error(kInvalidInput) when the map is empty or names an unknown family.
DetectorOptions detector_options_for(const Camera& camera, const TagMap& map, const DetectorOptions& options);

}  // namespace apriltrack
