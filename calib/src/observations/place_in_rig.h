#pragma once

#include <cstddef>

#include "apriltrack/camera/camera.h"

namespace apriltrack {

/// T_camera_rig: from the rig, which is its first camera, to camera `index`. One that is used alone needs no
/// extrinsics: where the file gives none, the rig is that camera. Throws Error(kInvalidInput) where one of
/// several has none.
Pose place_in_rig(const CameraRig& rig, std::size_t index, bool is_one_of_several);

}  // namespace apriltrack
