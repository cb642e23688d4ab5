#include "apriltrack/photometric/light.h"

#include <limits>
#include <utility>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

Image<float> halved(const Image<float>& image) {
  Image<float> half(image.width() / 2, image.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    const float* top = image.row(2 * y);
    const float* bottom = image.row(2 * y + 1);
    float* out = half.row(y);
    for (int x = 0; x < half.width(); ++x)
      out[x] = 0.25F * (top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1]);
  }
  return half;
}

Eigen::Vector2f plane_ray(const CameraModel& model, const Eigen::Vector2d& pixel) {
  // Past 85 degrees off the axis, x / z loses its meaning as a measure.
  constexpr double kMinForward = 0.087;
  const std::optional<Eigen::Vector3d> ray = model.unproject(pixel);
  if (!ray || ray->z() < kMinForward)
    return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
  return (ray->head<2>() / ray->z()).cast<float>();
}

}  // namespace

LightPyramid light_pyramid(Image<float> light, int num_levels) {
  APRILTRACK_CHECK(num_levels >= 1, "a pyramid has a level at least");
  LightPyramid pyramid;
  pyramid.push_back(std::move(light));
  while (static_cast<int>(pyramid.size()) < num_levels) pyramid.push_back(halved(pyramid.back()));
  return pyramid;
}

PixelRays::PixelRays(const CameraModel& model, int width, int height, int num_levels) {
  for (int level = 0; level < num_levels; ++level) {
    Image<Eigen::Vector2f> rays(width >> level, height >> level, Eigen::Vector2f::Zero());
    for (int y = 0; y < rays.height(); ++y) {
      for (int x = 0; x < rays.width(); ++x)
        rays(x, y) = plane_ray(model, {base_pixel(x, level), base_pixel(y, level)});
    }
    levels_.push_back(std::move(rays));
  }
}

}  // namespace apriltrack
