#include "pixels_by_pose.h"

#include "apriltrack/camera/pixel_jacobian.h"

namespace apriltrack {

std::optional<PixelJacobian> pixel_by_view(const CameraModel& model, const Pose& view,
                                           const Eigen::Vector3d& point_map) {
  const Eigen::Vector3d point = view * point_map;
  Eigen::Matrix<double, 2, 3> by_point;
  if (!model.project(point, &by_point)) return std::nullopt;
  return pixel_jacobian(by_point, point);
}

}  // namespace apriltrack
