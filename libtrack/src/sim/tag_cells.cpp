#include "tag_cells.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {

TagCells::TagCells(const TagPattern& pattern)
    : width_(pattern.cells().width()),
      half_width_(0.5F * static_cast<float>(width_)),
      ink_(width_ + 2, width_ + 2, 0.0F),
      sums_(width_ + 1, width_ + 1, 0.0F) {
  for (int y = 0; y < width_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const float brightness = pattern.cells()(x, y);
      const float ink = std::isnan(brightness) ? 0.0F : 1.0F - brightness;
      ink_(x + 1, y + 1) = ink;
      sums_(x + 1, y + 1) = ink + sums_(x, y + 1) + sums_(x + 1, y) - sums_(x, y);
    }
  }
}

float TagCells::integral_to(float x, float y) const {
  const float limit = static_cast<float>(width_);
  const float cx = std::min(std::max(x, 0.0F), limit);
  const float cy = std::min(std::max(y, 0.0F), limit);
  const int ix = std::min(static_cast<int>(cx), width_ - 1);
  const int iy = std::min(static_cast<int>(cy), width_ - 1);
  const float fx = cx - static_cast<float>(ix);
  const float fy = cy - static_cast<float>(iy);
  const float* row_0 = sums_.row(iy) + ix;
  const float* row_1 = row_0 + width_ + 1;
  const float top = row_0[0] + fx * (row_0[1] - row_0[0]);
  const float bottom = row_1[0] + fx * (row_1[1] - row_1[0]);
  return top + fy * (bottom - top);
}

float TagCells::ink_in_box(float min_x, float max_x, float min_y, float max_y) const {
  const float x_0 = min_x + half_width_;
  const float x_1 = max_x + half_width_;
  const float y_0 = min_y + half_width_;
  const float y_1 = max_y + half_width_;
  return integral_to(x_1, y_1) - integral_to(x_0, y_1) - integral_to(x_1, y_0) + integral_to(x_0, y_0);
}

float TagCells::uniform_ink(float min_x, float max_x, float min_y, float max_y) const {
  const float high = static_cast<float>(width_ + 1);
  const auto cell = [&](float coordinate) {  // 0 and width + 1: the paper beyond the print
    return static_cast<int>(std::min(std::max(coordinate + half_width_ + 1.0F, 0.0F), high));
  };
  const int x = cell(min_x);
  const int y = cell(min_y);
  return x == cell(max_x) && y == cell(max_y) ? ink_(x, y) : -1.0F;
}

}  // namespace apriltrack
