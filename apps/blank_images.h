#pragma once

#include <cstddef>
#include <string>

#include "apriltrack/image/image.h"

namespace apriltrack::app {

/// Of one brightness, but for the sensor's noise: means over its blocks are within 4 grey levels.
bool is_blank(const GrayView& image);

/// Why a recording of nothing else gives no result, and what to ask.
std::string told_of_blank_images(std::size_t num_images);

}  // namespace apriltrack::app
