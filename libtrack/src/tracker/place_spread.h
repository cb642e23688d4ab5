#pragma once

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// Edge of a tag in the image, were it seen head-on from as far.
double tag_size_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& pose);

/// Largest standard deviation of the place of the tag's centre in the image, pixels, as a covariance of the
/// pose has it (of its right perturbation); 0 where the centre is not in front of the camera.
double place_sigma_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& pose,
                      const Matrix6d& covariance);

/// How far the tag's centre moves in the image from one pose to the other; infinite where one of the two does
/// not show it.
double place_shift_px(const PhotometricWorld& world, const PhotometricTag& tag, const Pose& from,
                      const Pose& to);

}  // namespace apriltrack
