#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "apriltrack/image/image.h"
#include "patch_kernels.h"

namespace apriltrack {

/// Some pixels; none when a last one lies before its first.
struct PixelBox {
  int first_column = 0, last_column = -1, first_row = 0, last_row = -1;

  bool is_empty() const { return last_column < first_column || last_row < first_row; }
  void add(const PixelBox& other);
};

struct LightRange {
  float darkest = std::numeric_limits<float>::infinity();
  float brightest = -std::numeric_limits<float>::infinity();
};

/// An image with its rows in pairs, as the patch kernels read it; piece by piece when it is asked for.
class RowPairs {
 public:
  /// Of another frame. Keeps its memory. Pixels brighter than max_light do not tell their light.
  void start(const ImageView<const float>& image, double max_light);
  /// Makes the pairs in the box, and those near it.
  void make(const PixelBox& box);

  const PairedRows& rows() const { return rows_; }

 private:
  void make_tile(int row, int column);

  ImageView<const float> image_;
  float max_light_ = 0.0F;
  PairedRows rows_;
  std::vector<std::int32_t> pairs_;
  int tiles_per_row_ = 0;
  std::vector<bool> is_made_;  ///< Tile by tile.
};

}  // namespace apriltrack
