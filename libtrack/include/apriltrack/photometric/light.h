#pragma once

#include <Eigen/Core>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/image/image.h"
#include "apriltrack/image/response.h"

namespace apriltrack {

/// Light of one frame on levels of half the resolution each, level 0 being the image itself. Pixel x of level
/// l covers the 2^l pixels of level 0 about base_pixel(x, l); its light is their mean, as a larger pixel's
/// would be.
using LightPyramid = std::vector<Image<float>>;

/// num_levels >= 1; rows and columns that do not fill a pixel of the next level are left out there.
LightPyramid light_pyramid(Image<float> light, int num_levels);
/// Of a raw image. The memory of a pyramid of the same size is used again: new memory is slower to write than
/// its numbers are to compute.
void fill_light_pyramid(const GrayView& image, const ResponseCurve& response, int num_levels,
                        LightPyramid& pyramid);

/// Place on level 0 of the centre of pixel `x` of level `level`, and back.
inline double base_pixel(double x, int level) {
  return (x + 0.5) * (1 << level) - 0.5;
}
inline double level_pixel(double x, int level) {
  return (x + 0.5) / (1 << level) - 0.5;
}

/// Rays of the pixels of one camera, as (x / z, y / z), level by level. NaN where the lens model ends or the
/// ray does not point forward: such pixels take no part.
class PixelRays {
 public:
  PixelRays(const CameraModel& model, int width, int height, int num_levels);

  int num_levels() const { return static_cast<int>(levels_.size()); }
  ImageView<const Eigen::Vector2f> level(int level) const {
    return levels_[static_cast<std::size_t>(level)].view();
  }

 private:
  std::vector<Image<Eigen::Vector2f>> levels_;
};

}  // namespace apriltrack
