#pragma once

#include "apriltrack/image/image.h"

namespace apriltrack {

/// Whether an image is of one brightness but for the sensor's noise, as with a covered lens: the means of its
/// blocks of 16 x 16 pixels lie within 4 grey levels. True for an empty image.
bool is_blank(const GrayView& image);

}  // namespace apriltrack
