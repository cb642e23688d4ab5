#pragma once

#include <vector>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// What a surface looks like: radiance or reflectance in linear light, with ever coarser copies, each texel
/// the mean of four of the level before, so that far surfaces do not alias.
class Texture {
 public:
  /// base: row 0 is the surface's smallest v. texel_m: edge of one texel on the surface.
  Texture(Image<float> base, double texel_m);

  int num_levels() const { return static_cast<int>(levels_.size()); }
  const Image<float>& level(int index) const { return levels_[static_cast<std::size_t>(index)]; }
  double texel_m() const { return texel_m_; }

 private:
  std::vector<Image<float>> levels_;
  double texel_m_;
};

}  // namespace apriltrack
