#include "uncertainty/linear_part.h"

#include <utility>

#include "apriltrack/calib/calibration_options.h"
#include "model/corner_views.h"

namespace apriltrack {

LinearPart::LinearPart(const Observations& observations, const CalibrationOptions& options,
                       const MapState& state, Part part_of_map, int held_tag)
    : part(std::move(part_of_map)), views(corner_views(observations, part.views, state)) {
  if (views.size() != part.views.size()) return;
  poses = PoseInformation::of(views, part.tags, held_tag);
  if (poses) scale = error_scale(views, *poses, expected_bias_variance(options));
}

double expected_bias_variance(const CalibrationOptions& options) {
  const double sigmas = options.corner_bias_px / options.corner_sigma_px;
  return sigmas * sigmas;
}

}  // namespace apriltrack
