#pragma once

#include <string>

#include "apriltrack/camera/camera.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

/// Why an image is none of this camera's: empty, or not of its resolution. "" where it may be: a camera
/// without a resolution (width or height 0) takes any.
std::string why_of_another_camera(const GrayView& image, const Camera& camera);

}  // namespace apriltrack
