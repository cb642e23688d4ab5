#pragma once

#include "apriltrack/image/image.h"

namespace apriltrack {

/// Every pixel becomes the brightest of the 3 x 3 around it: black shapes lose a pixel all round, and those
/// that only touch at a corner come apart.
GrayImage shrink_black(const GrayView& image);

}  // namespace apriltrack
