#pragma once

#include "apriltrack/image/image.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {

/// Integrals of a tag's ink over boxes in the tag's plane, exact: cells are squares of one brightness, so the
/// integral from the corner is bilinear within each cell (a summed-area table; Crow, SIGGRAPH 1984).
///
/// Coordinates in cells from the middle of the tag, x right, y down. Ink is 1 where black, 0 where white or
/// unprinted.
class TagCells {
 public:
  explicit TagCells(const TagPattern& pattern);

  /// Ink times area.
  float ink_in_box(float min_x, float max_x, float min_y, float max_y) const;
  /// Ink of the one cell that holds the whole box; negative when cells meet in it.
  float uniform_ink(float min_x, float max_x, float min_y, float max_y) const;

 private:
  float integral_to(float x, float y) const;

  int width_;
  float half_width_;
  Image<float> ink_;   ///< With one cell of blank paper on every side.
  Image<float> sums_;  ///< (width + 1)^2: ink left of and above a cell's corner.
};

}  // namespace apriltrack
