#include "tag_pixels.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

constexpr float kMinPresence = 0.25F;
/// Standard deviation of the surroundings over that of the tag's own pixels.
constexpr float kBackgroundSigma = 6.0F;
constexpr float kSaturatedLight = 0.985F;

/// The pixels of level 0 that the printed square passes; empty when a corner cannot be projected.
Eigen::AlignedBox2d swept_box(const CameraModel& model, const TagPrediction& prediction,
                              const PhotometricTag& tag) {
  Eigen::AlignedBox2d box;
  const double half = tag.half_size_m() * tag.half_extent;
  for (const Pose& T_camera_tag : {prediction.path()[0], prediction.T_camera_tag(), prediction.path()[1]}) {
    for (const Eigen::Vector3d& corner : tag_corners(2.0 * half)) {
      const auto pixel = model.project(T_camera_tag * corner);
      if (!pixel) return {};
      box.extend(*pixel);
    }
  }
  return box;
}

}  // namespace

Eigen::AlignedBox2i swept_pixels(const PhotometricWorld& world, const LightPyramid& light,
                                 const TagPrediction& prediction, const PhotometricTag& tag, int level) {
  const Image<float>& image = light[static_cast<std::size_t>(level)];
  const Eigen::AlignedBox2d box = swept_box(world.model, prediction, tag);
  if (box.isEmpty()) return {};
  // Clamped before it is an integer: what is nearly behind the camera may lie anywhere.
  const auto clamped = [&](double pixel, int size) {
    return static_cast<int>(std::clamp(level_pixel(pixel, level), -2.0, size + 1.0));
  };
  const int x0 = std::max(0, clamped(box.min().x(), image.width()));
  const int y0 = std::max(0, clamped(box.min().y(), image.height()));
  const int x1 = std::min(image.width() - 1, clamped(box.max().x(), image.width()) + 1);
  const int y1 = std::min(image.height() - 1, clamped(box.max().y(), image.height()) + 1);
  return {Eigen::Vector2i(x0, y0), Eigen::Vector2i(x1, y1)};
}

TagPixels select_pixels(const PhotometricWorld& world, const LightPyramid& light,
                        const TagPrediction& prediction, const Eigen::AlignedBox2i& swept, int level,
                        int max_pixels) {
  TagPixels result;
  if (swept.isEmpty()) return result;
  const Image<float>& image = light[static_cast<std::size_t>(level)];
  const auto rays = world.rays.level(level);
  const int x0 = swept.min().x(), y0 = swept.min().y(), x1 = swept.max().x(), y1 = swept.max().y();
  // Tags fill about half of their box.
  const double candidates = 0.5 * (x1 - x0 + 1.0) * (y1 - y0 + 1.0);
  result.stride = std::max(1, static_cast<int>(std::lround(std::sqrt(candidates / max_pixels))));
  for (int y = y0; y <= y1; y += result.stride) {
    // Every other row is shifted, so that edges along a column are met at more than one phase.
    const int shift = ((y - y0) / result.stride % 2) * (result.stride / 2);
    for (int x = x0 + shift; x <= x1; x += result.stride) {
      const Eigen::Vector2f& ray = rays(x, y);
      const float value = image(x, y);
      if (std::isnan(ray.x()) || value > kSaturatedLight) continue;
      const float presence = prediction.predict(ray).presence;
      if (presence < kMinPresence) continue;
      result.pixels.push_back({ray, value, std::hypot(1.0F, kBackgroundSigma * (1.0F - presence))});
    }
  }
  const double pixel = result.stride * (1 << level);
  result.area_px = static_cast<double>(result.pixels.size()) * pixel * pixel;
  return result;
}

}  // namespace apriltrack
