#include "active_tags.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace apriltrack {
namespace {

constexpr std::size_t kMinPixels = 12;
/// What a perfect model would still miss: print, glare, a lens that is sharper here than there.
constexpr double kModelErrorOfContrast = 0.03;
constexpr double kMinScale = 2e-3;

}  // namespace

std::vector<ActiveTag> active_tags(PhotometricWorld& world, const PhotometricFrame& frame,
                                   const MotionState& state, int level, int max_pixels,
                                   double extra_sigma_px) {
  std::vector<ActiveTag> active;
  for (std::size_t k = 0; k < world.tags.size(); ++k) {
    PhotometricTag& tag = world.tags[k];
    const TagPrediction prediction(world, tag, state, frame.exposure_s, level, extra_sigma_px);
    if (!prediction.is_visible()) continue;
    TagPixels pixels = select_pixels(world, frame.light, prediction, tag, level, max_pixels);
    if (pixels.pixels.size() < kMinPixels) continue;
    active.push_back({static_cast<int>(k), std::move(pixels), 0.0, prediction.path_px()});
  }
  return active;
}

double scale_of(const TagMisfit& misfit) {
  return std::max({misfit.residual_scale, kModelErrorOfContrast * std::abs(misfit.colours.gain), kMinScale});
}

}  // namespace apriltrack
