#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <variant>

#include "apriltrack/camera/distortion.h"

namespace apriltrack {

/// Focal lengths and principal point in pixels; pixel (0, 0) is the CENTRE of the top-left pixel.
struct Pinhole {
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
};

/// The lens: a pinhole behind one of the distortion models. Camera frame: x right, y down, z forward.
class CameraModel {
 public:
  /// Throws Error(kInvalidInput) that names the member and its value where a focal length is not finite and
  /// > 0, or a principal point not finite: these come from users' files as often as from code.
  CameraModel(const Pinhole& pinhole, const Distortion& distortion);

  /// Pixel at which a point of the camera frame (metres) is seen; nullopt when it lies behind the camera or
  /// outside the lens model's valid domain, where the polynomial folds back and would show it at a wrong
  /// place. jacobian: d pixel / d point, if asked.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_camera,
                                         Eigen::Matrix<double, 2, 3>* jacobian = nullptr) const;

  /// Unit ray of a pixel, converged to 1e-9 px; nullopt outside the model's valid domain.
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel) const;

  const Pinhole& pinhole() const { return pinhole_; }
  const Distortion& distortion() const { return distortion_; }
  /// "none", "radtan" or "equidistant".
  std::string distortion_name() const;

 private:
  Pinhole pinhole_;
  Distortion distortion_;
};

/// Unit rays of a tag's corners, what solve_planar_pnp() takes; nullopt when a corner is not finite or has no
/// ray.
std::optional<std::array<Eigen::Vector3d, 4>> corner_rays(const CameraModel& model,
                                                          const std::array<Eigen::Vector2d, 4>& corners_px);

/// Pixel of a point before the camera. Unlike CameraModel::project, the lens formula is continued beyond its
/// valid domain, so that an error is a number for every pose: not for tracking. Not finite at a pole of the
/// formula. Requires z != 0.
Eigen::Vector2d project_continued(const CameraModel& model, const Eigen::Vector3d& point_camera);

}  // namespace apriltrack
