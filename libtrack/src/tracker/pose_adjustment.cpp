#include "pose_adjustment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/camera/pixel_jacobian.h"
#include "apriltrack/geometry/tag_view.h"

namespace apriltrack {
namespace {

constexpr double kUnseen_px = 1e3;
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
    CornerErrors errors = CornerErrors::Zero();
    Eigen::Matrix<double, 2 * kNumCorners, 6> J = Eigen::Matrix<double, 2 * kNumCorners, 6>::Zero();
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      Eigen::Matrix<double, 2, 3> d_pixel_d_point;
      const auto pixel = model.project(T_camera_map * observation->corners_map[i], &d_pixel_d_point);
      if (!pixel) continue;
      const auto row = 2 * static_cast<Eigen::Index>(i);
      errors.segment<2>(row) = *pixel - observation->corners_px[i];
      J.middleRows<2>(row) = pixel_jacobian(d_pixel_d_point * R, observation->corners_map[i]);
    }
    errors = (observation->whitening_per_px * errors).eval();
    J = (observation->whitening_per_px * J).eval();
    for (Eigen::Index row = 0; row < errors.size(); row += 2) {
      const auto error = errors.segment<2>(row);
      const auto by_pose = J.middleRows<2>(row);
      const double weight = kernel != nullptr ? kernel->weight(error.squaredNorm()) : 1.0;
      equations.hessian += weight * by_pose.transpose() * by_pose;
      equations.gradient += weight * by_pose.transpose() * error;
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

double RobustKernel::cost(double squared_error) const {
  const double scale2 = scale * scale;
  if (shape == Shape::kCauchy) return scale2 * std::log1p(squared_error / scale2);
  return squared_error <= scale2 ? squared_error : 2.0 * scale * std::sqrt(squared_error) - scale2;
}

double RobustKernel::weight(double squared_error) const {
  const double scale2 = scale * scale;
  if (shape == Shape::kCauchy) return scale2 / (scale2 + squared_error);
  return squared_error <= scale2 ? 1.0 : scale / std::sqrt(squared_error);
}

std::optional<CornerErrors> corner_errors_px(const CameraModel& model, const TagObservation& observation,
                                             const Pose& T_camera_map) {
  const Pose T_camera_tag = T_camera_map * observation.tag->T_map_tag;
  if (!(tag_view_cosine(T_camera_tag) > 0.0)) return std::nullopt;
  CornerErrors errors_px;
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto pixel = model.project(T_camera_map * observation.corners_map[i]);
    if (!pixel) return std::nullopt;
    errors_px.segment<2>(2 * static_cast<Eigen::Index>(i)) = *pixel - observation.corners_px[i];
  }
  return errors_px;
}

double squared_error(const CameraModel& model, const TagObservation& observation, const Pose& T_camera_map) {
  const auto errors_px = corner_errors_px(model, observation, T_camera_map);
  if (!errors_px) return std::numeric_limits<double>::infinity();
  return (observation.whitening_per_px * *errors_px).squaredNorm();
}

double robust_cost(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                   const RobustKernel& kernel, const Pose& T_camera_map) {
  double sum = 0.0;
  for (const TagObservation* observation : observations) {
    CornerErrors errors_px;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const auto pixel = model.project(T_camera_map * observation->corners_map[i]);
      auto error_px = errors_px.segment<2>(2 * static_cast<Eigen::Index>(i));
      error_px = Eigen::Vector2d(kUnseen_px, 0.0);
      if (!pixel) continue;
      const Eigen::Vector2d seen_px = *pixel - observation->corners_px[i];
      error_px = seen_px * std::min(1.0, kUnseen_px / seen_px.norm());
    }
    const CornerErrors errors = observation->whitening_per_px * errors_px;
    for (Eigen::Index row = 0; row < errors.size(); row += 2)
      sum += kernel.cost(errors.segment<2>(row).squaredNorm());
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
