#pragma once

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// `options` with the map's families and the camera's response: how the map's tags are detected in its
/// images. Throws what check_tag_map() throws.
DetectorOptions detector_options_for(const Camera& camera, const TagMap& map, DetectorOptions options);

}  // namespace apriltrack
