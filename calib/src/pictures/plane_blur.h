#pragma once

#include <Eigen/Core>
#include <optional>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/blurred_pattern.h"

namespace apriltrack {

/// What smears a picture in the image.
struct ImageBlur {
  double psf_sigma_px = 0.5;                            ///< The lens.
  Eigen::Vector2d streak_px = Eigen::Vector2d::Zero();  ///< Way of the tag's centre during the exposure.
};

/// The blur of the image as the tag's plane has it, along its axes, at its centre; in half tag sizes.
struct PlaneBlur {
  PatternBlur pattern;
  Eigen::Matrix2d covariance_by_psf = Eigen::Matrix2d::Zero();  ///< Per pixel of psf_sigma_px.
};

/// nullopt where the camera does not see the centre, or the plane from its edge.
std::optional<PlaneBlur> plane_blur(const CameraModel& camera, const Pose& T_camera_tag, double half_size_m,
                                    const ImageBlur& blur);

}  // namespace apriltrack
