#include "apriltrack/photometric/light.h"

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

void fit_size(int width, int height, Image<float>& image) {
  if (image.width() != width || image.height() != height) image = Image<float>(width, height);
}

void halve(const Image<float>& image, Image<float>& half) {
  fit_size(image.width() / 2, image.height() / 2, half);
  for (int y = 0; y < half.height(); ++y) {
    const float* top = image.row(2 * y);
    const float* bottom = image.row(2 * y + 1);
    float* out = half.row(y);
    for (int x = 0; x < half.width(); ++x)
      out[x] = 0.25F * (top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1]);
  }
}

void fill_coarse_levels(LightPyramid& pyramid) {
  for (std::size_t level = 1; level < pyramid.size(); ++level) halve(pyramid[level - 1], pyramid[level]);
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
  LightPyramid pyramid(static_cast<std::size_t>(num_levels));
  pyramid.front() = std::move(light);
  fill_coarse_levels(pyramid);
  return pyramid;
}

void fill_light_pyramid(const GrayView& image, const ResponseCurve& response, int num_levels,
                        LightPyramid& pyramid) {
  APRILTRACK_CHECK(num_levels >= 1, "a pyramid has a level at least");
  pyramid.resize(static_cast<std::size_t>(num_levels));
  fit_size(image.width(), image.height(), pyramid.front());
  const std::array<float, 256>& light_of = response.linear_light();
  for (int y = 0; y < image.height(); ++y) {
    const std::uint8_t* codes = image.row(y);
    float* light = pyramid.front().row(y);
    for (int x = 0; x < image.width(); ++x) light[x] = light_of[codes[x]];
  }
  fill_coarse_levels(pyramid);
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
