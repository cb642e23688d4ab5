#pragma once

#include <Eigen/Core>
#include <optional>

#include "apriltrack/camera/camera_model.h"

namespace apriltrack {

/// The surroundings of one pixel as a pinhole camera that looks there would show them: straight lines are
/// straight, however wide the lens is. Coordinates in pixels, the same as the image's at the middle, where
/// they are stretched evenly on average.
class StraightView {
 public:
  /// nullopt where the lens model has no ray at the middle, or none beside it.
  static std::optional<StraightView> about(const Eigen::Vector2d& middle_px, const CameraModel& camera);

  /// Of a pixel of the image; nullopt outside the lens model's domain, or 80 degrees and more off the middle.
  std::optional<Eigen::Vector2d> straight(const Eigen::Vector2d& pixel) const;
  /// Pixel of the image; nullopt outside the lens model's domain. derivative: d pixel / d straight.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector2d& straight, Eigen::Matrix2d* derivative) const;
  /// At the middle: d straight / d pixel.
  const Eigen::Matrix2d& straight_by_pixel() const { return straight_by_pixel_; }

 private:
  StraightView(const Eigen::Vector2d& middle_px, const CameraModel& camera,
               const Eigen::Matrix3d& R_view_camera)
      : middle_px_(middle_px), camera_(&camera), R_view_camera_(R_view_camera) {}

  Eigen::Vector2d middle_px_;
  const CameraModel* camera_;
  Eigen::Matrix3d R_view_camera_;
  double focal_px_ = 1.0;
  Eigen::Matrix2d straight_by_pixel_ = Eigen::Matrix2d::Identity();
};

}  // namespace apriltrack
