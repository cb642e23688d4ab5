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
Eigen::AlignedBox2d swept_box(const CameraModel& model, const TagSight& sight, const PhotometricTag& tag) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Matrix3d& camera_from_plane : sight.camera_from_plane()) {
    for (const double u : {-tag.half_extent, tag.half_extent}) {
      for (const double v : {-tag.half_extent, tag.half_extent}) {
        const auto pixel = model.project(camera_from_plane * Eigen::Vector3d(u, v, 1.0));
        if (!pixel) return {};
        box.extend(*pixel);
      }
    }
  }
  return box;
}

/// Cuts off what lies beyond `count`, and fills up to whole blocks.
void resize(std::vector<float>& column, std::size_t count) {
  column.resize(count);
  column.resize(padded(count), 0.0F);
}

/// Those of `swept` that have a ray and a light.
void find_candidates(const PhotometricWorld& world, const LightPyramid& light,
                     const Eigen::AlignedBox2i& swept, int level, int max_pixels, TagPixels& pixels) {
  const Image<float>& image = light[static_cast<std::size_t>(level)];
  const auto rays = world.rays.level(level);
  const int x0 = swept.min().x(), y0 = swept.min().y(), x1 = swept.max().x(), y1 = swept.max().y();
  // Tags fill about half of their box.
  const double num_candidates = 0.5 * (x1 - x0 + 1.0) * (y1 - y0 + 1.0);
  pixels.stride = std::max(1, static_cast<int>(std::lround(std::sqrt(num_candidates / max_pixels))));
  const auto steps = [&](int first, int last) {
    return static_cast<std::size_t>((last - first) / pixels.stride + 1);
  };
  for (std::vector<float>* column : pixels.columns()) column->resize(padded(steps(x0, x1) * steps(y0, y1)));
  std::size_t count = 0;
  for (int y = y0; y <= y1; y += pixels.stride) {
    // Every other row is shifted, so that edges along a column are met at more than one phase.
    const int shift = ((y - y0) / pixels.stride % 2) * (pixels.stride / 2);
    const float* line = image.row(y);
    const Eigen::Vector2f* line_rays = rays.row(y);
    for (int x = x0 + shift; x <= x1; x += pixels.stride) {
      const Eigen::Vector2f& ray = line_rays[x];
      if (std::isnan(ray.x()) || line[x] > kSaturatedLight) continue;
      pixels.ray_x[count] = ray.x();
      pixels.ray_y[count] = ray.y();
      pixels.image[count++] = line[x];
    }
  }
  pixels.count = count;
  for (std::vector<float>* column : pixels.columns()) resize(*column, count);
}

/// Those that the tag covers, with the errors to expect of them.
void keep_covered(TagPixels& pixels, PredictedPixels& predicted) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pixels.count; ++i) {
    const float presence = predicted.presence[i];
    if (presence < kMinPresence) continue;
    pixels.ray_x[kept] = pixels.ray_x[i];
    pixels.ray_y[kept] = pixels.ray_y[i];
    pixels.image[kept] = pixels.image[i];
    predicted.light[kept] = predicted.light[i];
    predicted.presence[kept] = presence;
    const float beyond = kBackgroundSigma * (1.0F - presence);
    pixels.inverse_sigma[kept] = 1.0F / std::sqrt(1.0F + beyond * beyond);
    ++kept;
  }
  pixels.count = kept;
  for (std::vector<float>* column : pixels.columns()) resize(*column, kept);
  resize(predicted.light, kept);
  resize(predicted.presence, kept);
}

}  // namespace

Eigen::AlignedBox2i swept_pixels(const PhotometricWorld& world, const LightPyramid& light,
                                 const TagSight& sight, const PhotometricTag& tag, int level) {
  const Image<float>& image = light[static_cast<std::size_t>(level)];
  const Eigen::AlignedBox2d box = swept_box(world.model, sight, tag);
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

void predict(const TagPrediction& prediction, const TagPixels& pixels, PredictedPixels* predicted) {
  predicted->light.resize(pixels.ray_x.size());
  predicted->presence.resize(pixels.ray_x.size());
  predict_pixels(prediction.texel_path(), pixels.rays(), predicted->light.data(), predicted->presence.data());
}

void select_pixels(const PhotometricWorld& world, const LightPyramid& light, const TagPrediction& prediction,
                   const Eigen::AlignedBox2i& swept, int level, int max_pixels, TagPixels* pixels,
                   PredictedPixels* predicted) {
  find_candidates(world, light, swept, level, max_pixels, *pixels);
  predict(prediction, *pixels, predicted);
  keep_covered(*pixels, *predicted);
  const double pixel = pixels->stride * (1 << level);
  pixels->area_px = static_cast<double>(pixels->count) * pixel * pixel;
}

}  // namespace apriltrack
