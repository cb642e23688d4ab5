#pragma once

#include <string>
#include <string_view>

#include "image_values.h"
#include "ros_message.h"

namespace apriltrack {

/// Grey values of a picture in a message, the same as of a file with these pixels. Throws BadMessage that
/// names the encoding, where it is not read, or what does not fit together.
ImageValues values_of(const RosImage& image);
ImageValues values_of(const RosCompressedImage& image);

}  // namespace apriltrack
