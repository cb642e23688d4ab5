#pragma once

#include <string>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// A grey PNG of a tag's cells, a pixel each: 0 black, 1 white, what is not printed white. Stored, not
/// packed: a tag's picture has a hundred bytes.
std::string png_of_cells(const Image<float>& cells);

}  // namespace apriltrack
