#pragma once

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// Largest standard deviation of the place of the tag's centre in the image, pixels, as a covariance of the
/// pose has it (of its right perturbation); 0 where the centre is not in front of the camera.
double place_sigma_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& pose,
                      const Matrix6d& covariance);

}  // namespace apriltrack
