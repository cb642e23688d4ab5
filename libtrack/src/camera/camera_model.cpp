#include "apriltrack/camera/camera_model.h"

#include <fmt/format.h>

#include <cmath>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

struct NameOf {
  const char* operator()(const NoDistortion&) const { return "none"; }
  const char* operator()(const RadtanDistortion&) const { return "radtan"; }
  const char* operator()(const EquidistantDistortion&) const { return "equidistant"; }
};

void check_focal_length(double value_px, const char* member) {
  if (value_px > 0.0 && std::isfinite(value_px)) return;
  throw invalid_input("Pinhole", fmt::format("{} must be finite and > 0 pixels (is {})", member, value_px));
}

void check_principal_point(double value_px, const char* member) {
  if (std::isfinite(value_px)) return;
  throw invalid_input("Pinhole",
                      fmt::format("{} must be a finite number of pixels (is {})", member, value_px));
}

}  // namespace

CameraModel::CameraModel(const Pinhole& pinhole, const Distortion& distortion)
    : pinhole_(pinhole), distortion_(distortion) {
  check_focal_length(pinhole.fx, "fx");
  check_focal_length(pinhole.fy, "fy");
  check_principal_point(pinhole.cx, "cx");
  check_principal_point(pinhole.cy, "cy");
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& point_camera,
                                                    Eigen::Matrix<double, 2, 3>* jacobian) const {
  const auto distorted =
      std::visit([&](const auto& lens) { return lens.distort(point_camera, jacobian); }, distortion_);
  if (!distorted) return std::nullopt;
  const Eigen::Vector2d focal(pinhole_.fx, pinhole_.fy);
  const Eigen::Vector2d pixel = focal.cwiseProduct(*distorted) + Eigen::Vector2d(pinhole_.cx, pinhole_.cy);
  if (!pixel.allFinite()) return std::nullopt;
  if (jacobian) *jacobian = (focal.asDiagonal() * *jacobian).eval();
  return pixel;
}

std::optional<Eigen::Vector3d> CameraModel::unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted((pixel.x() - pinhole_.cx) / pinhole_.fx,
                                  (pixel.y() - pinhole_.cy) / pinhole_.fy);
  return std::visit([&](const auto& lens) { return lens.undistort(distorted); }, distortion_);
}

std::optional<std::array<Eigen::Vector3d, 4>> corner_rays(const CameraModel& model,
                                                          const std::array<Eigen::Vector2d, 4>& corners_px) {
  std::array<Eigen::Vector3d, 4> rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!corners_px[i].allFinite()) return std::nullopt;
    const auto ray = model.unproject(corners_px[i]);
    if (!ray) return std::nullopt;
    rays[i] = *ray;
  }
  return rays;
}

Eigen::Vector2d project_continued(const CameraModel& model, const Eigen::Vector3d& point_camera) {
  if (const auto pixel = model.project(point_camera)) return *pixel;
  const Eigen::Vector2d undistorted = point_camera.head<2>() / point_camera.z();
  const Eigen::Vector2d distorted =
      std::visit([&](const auto& lens) { return lens.distort_continued(undistorted); }, model.distortion());
  const Pinhole& pinhole = model.pinhole();
  return {pinhole.fx * distorted.x() + pinhole.cx, pinhole.fy * distorted.y() + pinhole.cy};
}

std::string CameraModel::distortion_name() const {
  return std::visit(NameOf{}, distortion_);
}

}  // namespace apriltrack
