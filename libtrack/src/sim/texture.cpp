#include "apriltrack/sim/texture.h"

#include <algorithm>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

constexpr int kSmallestLevel_px = 8;

Image<float> halve(const Image<float>& fine) {
  Image<float> coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2);
  for (int y = 0; y < coarse.height(); ++y) {
    const float* row_0 = fine.row(2 * y);
    const float* row_1 = fine.row(std::min(2 * y + 1, fine.height() - 1));
    for (int x = 0; x < coarse.width(); ++x) {
      const int x_0 = 2 * x;
      const int x_1 = std::min(x_0 + 1, fine.width() - 1);
      coarse(x, y) = 0.25F * (row_0[x_0] + row_0[x_1] + row_1[x_0] + row_1[x_1]);
    }
  }
  return coarse;
}

}  // namespace

Texture::Texture(Image<float> base, double texel_m) : texel_m_(texel_m) {
  APRILTRACK_CHECK(base.width() >= 2 && base.height() >= 2, "a texture needs 2 x 2 texels or more");
  APRILTRACK_CHECK(texel_m > 0.0, "texel_m must be > 0");
  levels_.push_back(std::move(base));
  while (std::min(levels_.back().width(), levels_.back().height()) >= 2 * kSmallestLevel_px) {
    levels_.push_back(halve(levels_.back()));
  }
}

}  // namespace apriltrack
