#include "straight_view.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace apriltrack {
namespace {

constexpr double kMinCosine = 0.17;  // 80 degrees: beyond, a pinhole's picture is stretched without end

}  // namespace

std::optional<StraightView> StraightView::about(const Eigen::Vector2d& middle_px, const CameraModel& camera) {
  const std::optional<Eigen::Vector3d> ray = camera.unproject(middle_px);
  if (!ray) return std::nullopt;
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(*ray, Eigen::Vector3d::UnitZ());
  StraightView view(middle_px, camera, turn.toRotationMatrix());
  Eigen::Matrix2d pixel_by_straight;
  if (!view.pixel(middle_px, &pixel_by_straight)) return std::nullopt;
  const double area = std::abs(pixel_by_straight.determinant());
  if (!(area > 0.0)) return std::nullopt;
  view.focal_px_ = std::sqrt(area);
  view.straight_by_pixel_ = view.focal_px_ * pixel_by_straight.inverse();
  return view;
}

std::optional<Eigen::Vector2d> StraightView::straight(const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector3d> ray_camera = camera_->unproject(pixel);
  if (!ray_camera) return std::nullopt;
  const Eigen::Vector3d ray = R_view_camera_ * *ray_camera;
  if (!(ray.z() > kMinCosine)) return std::nullopt;
  return middle_px_ + focal_px_ * ray.hnormalized();
}

std::optional<Eigen::Vector2d> StraightView::pixel(const Eigen::Vector2d& straight,
                                                   Eigen::Matrix2d* derivative) const {
  const Eigen::Vector3d ray = ((straight - middle_px_) / focal_px_).homogeneous();
  Eigen::Matrix<double, 2, 3> by_ray;
  const auto pixel = camera_->project(R_view_camera_.transpose() * ray, derivative ? &by_ray : nullptr);
  if (derivative && pixel) *derivative = by_ray * R_view_camera_.transpose().leftCols<2>() / focal_px_;
  return pixel;
}

}  // namespace apriltrack
