#include "tag_boxes.h"

#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

constexpr double kInk_m = 1e-4;    // thickness of a bar: enough to hide the sheet at any distance
constexpr double kSheet_m = 1e-3;  // of the sheet behind it
constexpr float kBlack = 0.5f;     // cells that nobody prints are NaN, and white

/// A run of black cells of one row; half tag sizes, u right, v down.
TagBox bar(double u, double v, double width, double height, double half_size_m) {
  return {{half_size_m * (u + 0.5 * width), half_size_m * (v + 0.5 * height), 0.5 * kInk_m},
          {half_size_m * width, half_size_m * height, kInk_m},
          true};
}

}  // namespace

std::vector<TagBox> boxes_of(const MapTag& tag) {
  const TagPattern pattern = TagFamily::get(tag.key.family).pattern(tag.key.id);
  const double half_size_m = 0.5 * tag.size_m;
  const double extent = pattern.half_extent(), cell = pattern.cell_size();
  const Image<float>& cells = pattern.cells();
  std::vector<TagBox> boxes = {{{0.0, 0.0, kInk_m + 0.5 * kSheet_m},
                                {2.0 * extent * half_size_m, 2.0 * extent * half_size_m, kSheet_m},
                                false}};
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width();) {
      int end = x;
      while (end < cells.width() && cells(end, y) < kBlack) ++end;
      if (end > x)
        boxes.push_back(bar(-extent + x * cell, -extent + y * cell, (end - x) * cell, cell, half_size_m));
      x = end > x ? end : x + 1;
    }
  }
  return boxes;
}

}  // namespace apriltrack
