#pragma once

#include <string>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// The bytes of a grey JPEG file. quality: 0 to 100. Throws Error(kIo) where it cannot be encoded.
std::string jpeg_picture(const GrayView& image, int quality);

}  // namespace apriltrack
