#include "apriltrack/calib/fit_lenses.h"

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "initialise/lens_by_single_views.h"

namespace apriltrack {
namespace {

/// nullopt where no view can be used.
std::optional<Observations> usable_views(std::span<const FrameDetections> frames, const CameraRig& rig) {
  const TagSizes any_size(1.0);
  UnusedDetections unused;
  try {
    return collect_observations(frames, rig, any_size, {}, unused);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kNoResult) throw;
    return std::nullopt;
  }
}

}  // namespace

std::optional<CameraRig> fit_lenses(std::span<const FrameDetections> frames, const CameraRig& rig,
                                    int num_threads) {
  const auto observations = usable_views(frames, rig);
  if (!observations) return std::nullopt;
  CameraRig result = rig;
  bool is_any_other = false;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const auto model = lens_by_single_views(*observations, static_cast<int>(c), parallel_for(num_threads));
    if (!model) continue;
    result.cameras[c].model = *model;
    is_any_other = true;
  }
  return is_any_other ? std::optional(result) : std::nullopt;
}

}  // namespace apriltrack
