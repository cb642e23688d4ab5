#include "pose_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/camera/pixel_jacobian.h"
#include "apriltrack/geometry/tag_view.h"

namespace apriltrack {
namespace {

constexpr double kUnseen_px2 = 1e6;
constexpr int kMaxIterations = 30;
constexpr double kStepTolerance = 1e-10;  // of the scene's depth, and in radians: 1e-7 px
constexpr double kMaxDamping = 1e6;

struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

NormalEquations linearise(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                          const RobustKernel* kernel, const Pose& T_camera_map) {
  NormalEquations equations;
  const Eigen::Matrix3d R = T_camera_map.rotation_matrix();
  for (const TagObservation* observation : observations) {
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      Eigen::Matrix<double, 2, 3> d_pixel_d_point;
      const auto pixel = model.project(T_camera_map * observation->corners_map[i], &d_pixel_d_point);
      if (!pixel) continue;
      const Eigen::Vector2d error = *pixel - observation->corners_px[i];
      const double weight = kernel != nullptr ? kernel->weight(error.squaredNorm()) : 1.0;
      const auto jacobian = pixel_jacobian(d_pixel_d_point * R, observation->corners_map[i]);
      equations.hessian += weight * jacobian.transpose() * jacobian;
      equations.gradient += weight * jacobian.transpose() * error;
    }
  }
  return equations;
}

/// Distance of the observed corners from the camera: what a translation step is measured by.
double scene_depth(const std::vector<const TagObservation*>& observations, const Pose& T_camera_map) {
  double depth = 0.0;
  for (const TagObservation* observation : observations) {
    depth = std::max(depth, (T_camera_map * observation->tag->T_map_tag.translation()).norm());
  }
  return std::max(depth, std::numeric_limits<double>::min());
}

}  // namespace

double RobustKernel::cost(double squared_error_px2) const {
  const double scale2 = scale_px * scale_px;
  if (shape == Shape::kCauchy) return scale2 * std::log1p(squared_error_px2 / scale2);
  return squared_error_px2 <= scale2 ? squared_error_px2
                                     : 2.0 * scale_px * std::sqrt(squared_error_px2) - scale2;
}

double RobustKernel::weight(double squared_error_px2) const {
  const double scale2 = scale_px * scale_px;
  if (shape == Shape::kCauchy) return scale2 / (scale2 + squared_error_px2);
  return squared_error_px2 <= scale2 ? 1.0 : scale_px / std::sqrt(squared_error_px2);
}

double squared_error_px2(const CameraModel& model, const TagObservation& observation,
                         const Pose& T_camera_map) {
  const Pose T_camera_tag = T_camera_map * observation.tag->T_map_tag;
  if (!(tag_view_cosine(T_camera_tag) > 0.0)) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto pixel = model.project(T_camera_map * observation.corners_map[i]);
    if (!pixel) return std::numeric_limits<double>::infinity();
    sum += (*pixel - observation.corners_px[i]).squaredNorm();
  }
  return sum;
}

double robust_cost(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                   const RobustKernel& kernel, const Pose& T_camera_map) {
  double sum = 0.0;
  for (const TagObservation* observation : observations) {
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const auto pixel = model.project(T_camera_map * observation->corners_map[i]);
      const double error = pixel ? (*pixel - observation->corners_px[i]).squaredNorm() : kUnseen_px2;
      sum += kernel.cost(std::min(error, kUnseen_px2));
    }
  }
  return sum;
}

Pose adjust_pose(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                 const RobustKernel& kernel, Pose T_camera_map) {
  double cost = robust_cost(model, observations, kernel, T_camera_map);
  double damping = 1e-4;
  for (int i = 0; i < kMaxIterations && damping < kMaxDamping; ++i) {
    NormalEquations equations = linearise(model, observations, &kernel, T_camera_map);
    equations.hessian.diagonal() *= 1.0 + damping;
    const Vector6d step = -equations.hessian.ldlt().solve(equations.gradient);
    const Pose candidate = T_camera_map * Pose::exp(step);
    const double candidate_cost = step.allFinite() ? robust_cost(model, observations, kernel, candidate)
                                                   : std::numeric_limits<double>::infinity();
    if (!(candidate_cost <= cost)) {
      damping *= 10.0;
      continue;
    }
    const double moved_m = (candidate.inverse().translation() - T_camera_map.inverse().translation()).norm();
    const double relative_step = moved_m / scene_depth(observations, candidate) + step.tail<3>().norm();
    T_camera_map = candidate;
    cost = candidate_cost;
    damping = std::max(1e-12, 0.1 * damping);
    if (relative_step < kStepTolerance) break;
  }
  return T_camera_map;
}

Matrix6d corner_information(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                            const Pose& T_camera_map) {
  return linearise(model, observations, nullptr, T_camera_map).hessian;
}

}  // namespace apriltrack
