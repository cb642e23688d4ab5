#include "active_tags.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace apriltrack {
namespace {

constexpr std::size_t kMinPixels = 12;
/// All tags of a frame together: 14 with all that is asked for, as many as a room shows; what a frame of
/// hundreds costs does not grow with them, until they are down to what still tells one tag from another.
constexpr int kPixelsPerFrame = 10'000;
constexpr int kLeastPixelsPerTag = 64;
/// What a perfect model would still miss: print, glare, a lens that is sharper here than there.
constexpr double kModelErrorOfContrast = 0.03;
constexpr double kMinScale = 2e-3;

/// A tag whose square passes through the image.
struct TagInImage {
  int index = 0;
  TagPrediction prediction;
  Eigen::AlignedBox2i swept;
};

std::vector<TagInImage> tags_in_image(PhotometricWorld& world, const PhotometricFrame& frame,
                                      const MotionState& state, int level, double extra_sigma_px,
                                      bool with_hidden) {
  std::vector<TagInImage> found;
  for (std::size_t k = 0; k < world.tags.size(); ++k) {
    PhotometricTag& tag = world.tags[k];
    if (tag.is_hidden && !with_hidden) continue;
    TagPrediction prediction(world, tag, state, frame.exposure_s, level, extra_sigma_px);
    if (!prediction.is_visible()) continue;
    const Eigen::AlignedBox2i swept = swept_pixels(world, frame.light, prediction, tag, level);
    if (!swept.isEmpty()) found.push_back({static_cast<int>(k), std::move(prediction), swept});
  }
  return found;
}

/// Of what is asked for, a tag's share when `num_tags` show.
int pixels_per_tag(int max_pixels, std::size_t num_tags) {
  const int share = kPixelsPerFrame / static_cast<int>(std::max<std::size_t>(1, num_tags));
  return std::min(max_pixels, std::max(kLeastPixelsPerTag, share));
}

}  // namespace

std::vector<ActiveTag> active_tags(PhotometricWorld& world, const PhotometricFrame& frame,
                                   const MotionState& state, int level, int max_pixels, double extra_sigma_px,
                                   bool with_hidden) {
  const std::vector<TagInImage> shown =
      tags_in_image(world, frame, state, level, extra_sigma_px, with_hidden);
  const int share = pixels_per_tag(max_pixels, shown.size());
  std::vector<ActiveTag> active;
  for (const TagInImage& tag : shown) {
    PredictedPixels predicted;
    TagPixels pixels = select_pixels(world, frame.light, tag.prediction, tag.swept, level, share, &predicted);
    if (pixels.count < kMinPixels) continue;
    active.push_back({tag.index, std::move(pixels), std::move(predicted), 0.0, tag.prediction.path_px()});
  }
  return active;
}

double scale_of(const TagMisfit& misfit) {
  return std::max({misfit.residual_scale, kModelErrorOfContrast * std::abs(misfit.colours.gain), kMinScale});
}

}  // namespace apriltrack
