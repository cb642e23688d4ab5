#include "apriltrack/calib/fit_lenses.h"

#include <numeric>

#include "apriltrack/base/error.h"
#include "lens_by_single_views.h"

namespace apriltrack {
namespace {

/// nullopt where no view can be used.
std::optional<Observations> usable_views(std::span<const FrameDetections> frames, const CameraRig& rig) {
  const TagSizes any_size(1.0);
  Findings findings;
  try {
    return collect_observations(frames, rig, any_size, {}, findings);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<CameraRig> fit_lenses(std::span<const FrameDetections> frames, const CameraRig& rig,
                                    int num_threads) {
  const auto observations = usable_views(frames, rig);
  if (!observations) return std::nullopt;
  std::vector<std::size_t> views(observations->views.size());
  std::iota(views.begin(), views.end(), std::size_t{0});
  const auto cameras = lens_by_single_views(*observations, views, parallel_for(num_threads));
  if (!cameras) return std::nullopt;
  CameraRig result = rig;
  for (std::size_t c = 0; c < cameras->size(); ++c) result.cameras[c].model = (*cameras)[c].model;
  return result;
}

}  // namespace apriltrack
