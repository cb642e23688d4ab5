#include "tag_pixels.h"

#include <algorithm>
#include <cmath>

#include "photometric_scratch.h"

namespace apriltrack {
namespace {

/// A pixel at the end of the path counts once the tag has passed it by so much, but for what lens and pixel
/// smear beyond a sharp tag. Without these faint ends a path too short may choose its own pixels, and look
/// better than the right one.
constexpr double kPassed_px = 1.0;
constexpr double kMinPresence = 0.05, kMinPresenceSharp = 0.25;
/// Standard deviation of the surroundings over that of the tag's own pixels.
constexpr float kBackgroundSigma = 3.0F;
constexpr float kSaturatedLight = 0.985F;

/// Cuts off what lies beyond `count`, and fills up to whole blocks.
void resize(std::vector<float>& column, std::size_t count) {
  column.resize(count);
  column.resize(padded(count), 0.0F);
}

/// Those of `swept` that have a ray and a light.
void find_candidates(const PhotometricWorld& world, const LightPyramid& light, const SweptArea& swept,
                     int level, int max_pixels, TagPixels& pixels) {
  const Image<float>& image = light[static_cast<std::size_t>(level)];
  const auto rays = world.rays.level(level);
  const int x0 = swept.box.min().x(), y0 = swept.box.min().y();
  const int x1 = swept.box.max().x(), y1 = swept.box.max().y();
  // Tags fill about half of their box.
  const double num_candidates = 0.5 * (x1 - x0 + 1.0) * (y1 - y0 + 1.0);
  pixels.stride = std::max(1, static_cast<int>(std::lround(std::sqrt(num_candidates / max_pixels))));
  const auto steps = [&](int first, int last) {
    return static_cast<std::size_t>((last - first) / pixels.stride + 1);
  };
  for (std::vector<float>* column : pixels.columns()) column->resize(padded(steps(x0, x1) * steps(y0, y1)));
  SweptRows& rows = world.scratch->swept_rows;
  rows.find(swept);
  std::size_t count = 0;
  for (int y = y0; y <= y1; y += pixels.stride) {
    // Every other row is shifted, so that edges along a column are met at more than one phase.
    const int shift = ((y - y0) / pixels.stride % 2) * (pixels.stride / 2);
    const float* line = image.row(y);
    const Eigen::Vector2f* line_rays = rays.row(y);
    const auto [first, last] = rows[y];
    const int skipped = std::max(0, (first - x0 - shift + pixels.stride - 1) / pixels.stride);
    for (int x = x0 + shift + skipped * pixels.stride; x <= last; x += pixels.stride) {
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
void keep_covered(double path_px, TagPixels& pixels, PredictedPixels& predicted) {
  const auto min_presence =
      static_cast<float>(std::clamp(kPassed_px / path_px, kMinPresence, kMinPresenceSharp));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pixels.count; ++i) {
    const float presence = predicted.presence[i];
    if (presence < min_presence) continue;
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

void predict(const TagPrediction& prediction, const TagPixels& pixels, PredictedPixels* predicted) {
  predicted->light.resize(pixels.ray_x.size());
  predicted->presence.resize(pixels.ray_x.size());
  predict_pixels(prediction.texel_path(), pixels.rays(), predicted->light.data(), predicted->presence.data());
}

void select_pixels(const PhotometricWorld& world, const LightPyramid& light, const TagPrediction& prediction,
                   const SweptArea& swept, int level, int max_pixels, TagPixels* pixels,
                   PredictedPixels* predicted) {
  find_candidates(world, light, swept, level, max_pixels, *pixels);
  predict(prediction, *pixels, predicted);
  keep_covered(prediction.path_px(), *pixels, *predicted);
  const double pixel = pixels->stride * (1 << level);
  pixels->area_px = static_cast<double>(pixels->count) * pixel * pixel;
}

}  // namespace apriltrack
