#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/camera/camera_formats.h"

namespace apriltrack {

// The text of one foreign file. All throw Error(kInvalidInput), without a place, where the format has no such
// lens model.

std::string ros_camera_info_text(const Camera& camera);
std::string opencv_text(const Camera& camera);
std::string wpilib_text(const Camera& camera);
std::string photonvision_text(const Camera& camera);
/// T_camera_reference: identity where the camera's place is not known.
std::string mrcal_text(const Camera& camera, const Pose& T_camera_reference);
std::string colmap_text(const std::vector<Camera>& cameras);

std::vector<double> coefficients_of(const CameraModel& model);
/// k1 k2 p1 p2 k3, or with k4 k5 k6 where the lens has them; zeros where it has none at all. Throws
/// Error(kInvalidInput) for a fisheye, which `format` has no model for.
std::vector<double> radtan_coefficients(const Camera& camera, std::string_view format);

/// "1, 2.5"; every number to the last digit.
std::string joined(const std::vector<double>& numbers, std::string_view between = ", ");
/// fx 0 cx 0 fy cy 0 0 1
std::vector<double> matrix_of(const CameraModel& model);

}  // namespace apriltrack
