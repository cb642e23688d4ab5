#pragma once

#include "apriltrack/image/image.h"

namespace apriltrack {

/// Every pixel becomes the brightest of the 3 x 3 around it: black shapes lose a pixel all round, and those
/// that only touch at a corner come apart.
GrayImage shrink_black(const GrayView& image);

/// Twice as wide and high, interpolated between the pixels: pixel (x, y) of the image is (2 x + 0.5, 2 y +
/// 0.5) here.
GrayImage enlarge_twice(const GrayView& image);

}  // namespace apriltrack
