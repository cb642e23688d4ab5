#include "model/view_residual.h"

#include "apriltrack/camera/pixel_jacobian.h"

namespace apriltrack {

bool view_residual(const RigCamera& camera, double size_m, const TagView& view, const Pose& T_map_rig,
                   const Pose& T_map_tag, Vector8d* residual_px, Matrix8x6d* by_rig, Matrix8x6d* by_tag) {
  const Pose T_rig_tag = T_map_rig.inverse() * T_map_tag;
  const Eigen::Matrix3d R_camera_rig = camera.T_camera_rig.rotation_matrix();
  const Eigen::Matrix3d R_rig_tag = T_rig_tag.rotation_matrix();
  const std::array<Eigen::Vector3d, kNumCorners> corners_tag = tag_corners(size_m);
  const bool has_derivatives = by_rig != nullptr || by_tag != nullptr;
  for (int i = 0; i < kNumCorners; ++i) {
    const auto corner = static_cast<std::size_t>(i);
    const Eigen::Vector3d point_rig = R_rig_tag * corners_tag[corner] + T_rig_tag.translation();
    Eigen::Matrix<double, 2, 3> by_point;
    const auto pixel = camera.model.project(R_camera_rig * point_rig + camera.T_camera_rig.translation(),
                                            has_derivatives ? &by_point : nullptr);
    if (!pixel) return false;
    residual_px->segment<2>(2 * i) = *pixel - view.corners_px[corner];
    if (!has_derivatives) continue;
    const Eigen::Matrix<double, 2, 3> by_point_rig = by_point * R_camera_rig;
    if (by_rig != nullptr) by_rig->middleRows<2>(2 * i) = -pixel_jacobian(by_point_rig, point_rig);
    if (by_tag != nullptr)
      by_tag->middleRows<2>(2 * i) = pixel_jacobian(by_point_rig * R_rig_tag, corners_tag[corner]);
  }
  *residual_px += camera.edge_offset_px * view.inward;
  return true;
}

}  // namespace apriltrack
