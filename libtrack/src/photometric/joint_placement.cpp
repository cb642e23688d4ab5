#include <Eigen/LU>
#include <algorithm>

#include "joint_workspace.h"

namespace apriltrack {
namespace {

/// Independent samples in a patch: one of more pixels than samples has no more than its samples.
double num_independent(const CameraModel& model, const Eigen::Matrix3d& camera_from_plane,
                       const PatchGrid& grid) {
  const double depth = camera_from_plane(2, 2);
  if (!(depth > 0.0)) return 0.0;
  // d pixel / d plane of the homography at the patch's centre, times the grid's area.
  const double area_px = model.pinhole().fx * model.pinhole().fy * camera_from_plane.determinant() /
                         (depth * depth * depth) * 4.0 * grid.half_extent * grid.half_extent;
  return std::clamp(area_px, 0.0, static_cast<double>(grid.num_samples())) / kPixelsPerIndependentSample;
}

}  // namespace

/// Writes the views of the batch's hypothesis at `position`. Most tags of a room are turned away or out of
/// view: they cost little more than where their centre is.
void JointLikelihood::place(const Batch& batch, std::size_t position) {
  const Pose T_camera_map = camera_from_map(batch.hypothesis(position).pose, mode_);
  const Eigen::Matrix3d R = T_camera_map.rotation_matrix();
  for (std::size_t k = 0; k < num_tags(); ++k) {
    PatchInView& view = work_->views[position * num_tags() + k];
    const Tag& tag = tags_[k];
    const Eigen::Vector3d centre = R * tag.map_from_plane.col(2) + T_camera_map.translation();
    view.is_in_view =
        takes_part(k) && (R * tag.normal_map).dot(centre) > 0.0 && work_->cone.may_show(centre, tag.radius_m);
    if (!view.is_in_view) continue;
    Eigen::Matrix3d M = R * tag.map_from_plane;
    M.col(2) = centre;
    view.num_independent = num_independent(model_, M, options_.grid);
    view.placed = place_patch(batch.frame.light[0].view(), model_, M, options_.grid);
    view.camera_from_plane = by_rows(M);
  }
}

/// Serially, for the textures are shared and made when first asked for. None without patterns.
void JointLikelihood::predict(const Batch& batch) {
  work_->predictions.clear();
  if (!world_) return;
  work_->predictions.reserve(work_->views.size());
  for (std::size_t position = 0; position < batch.selection.size(); ++position) {
    ViewPath path(batch.hypothesis(position), batch.frame.exposure_s, mode_);
    for (std::size_t k = 0; k < num_tags(); ++k) {
      PatchInView& view = work_->views[position * num_tags() + k];
      if (!view.is_in_view) continue;
      view.prediction = work_->predictions.size();
      view.is_in_view = work_->predictions.emplace_back(*world_, world_->tags[k], path, 0).is_visible();
    }
  }
}

/// Those parts of the image that the batch's patches lie on.
void JointLikelihood::make_rows() {
  PixelBox box;
  for (const PatchInView& view : work_->views)
    if (view.is_in_view) box.add(view.placed.box);
  work_->rows.make(box);
}

}  // namespace apriltrack
