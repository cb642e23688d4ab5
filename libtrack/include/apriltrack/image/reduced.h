#pragma once

#include <cstdint>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// A copy, halved (every pixel the rounded mean of 2 x 2; an odd last row or column is left out) until it has
/// `most_pixels` at most.
GrayImage reduced_copy(const GrayView& image, std::int64_t most_pixels);

}  // namespace apriltrack
