#pragma once

#include <vector>

#include "apriltrack/calib/map_constraints.h"
#include "model/map_state.h"
#include "numerics/linear_view.h"
#include "uncertainty/error_scale.h"

namespace apriltrack {

/// Throws Error(kInvalidInput) where a constraint names a camera that is not there, or a time at which that
/// one shows no tag.
void require_camera_frames(const std::vector<MapConstraint>& constraints, const Observations& observations);

/// Directions in a camera's frame as such in the frame of the largest tag that it shows at the time, the
/// error of the camera's pose included; constraints whose frame `views` does not show stay as they are.
/// views: of the map, linearised at `state`, as `used` lists them.  scale: of their errors.
std::vector<MapConstraint> with_gravity_of_tags(const std::vector<MapConstraint>& constraints,
                                                const Observations& observations,
                                                const std::vector<std::size_t>& used,
                                                const std::vector<LinearView>& views, const MapState& state,
                                                const ErrorScale& scale);

}  // namespace apriltrack
