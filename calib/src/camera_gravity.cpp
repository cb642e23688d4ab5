#include "camera_gravity.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

bool is_of(const CameraGravityConstraint& gravity, const TagView& view, const Observations& observations) {
  return observations.cameras[static_cast<std::size_t>(view.camera)].name == gravity.camera &&
         observations.frames[static_cast<std::size_t>(view.frame)] == gravity.timestamp;
}

/// Variance of a frame's orientation, about its worst axis, the tags held.
std::optional<double> orientation_variance(const std::vector<LinearView>& views, int frame) {
  Matrix6d information = Matrix6d::Zero();
  for (const LinearView& view : views) {
    if (view.frame == frame) information += view.by_rig.transpose() * view.by_rig;
  }
  const Eigen::LDLT<Matrix6d> factor(information);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return std::nullopt;
  const Matrix6d covariance = factor.solve(Matrix6d::Identity());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance.bottomRightCorner<3, 3>())
      .eigenvalues()
      .maxCoeff();
}

}  // namespace

void require_camera_frames(const std::vector<MapConstraint>& constraints, const Observations& observations) {
  for (const MapConstraint& constraint : constraints) {
    const auto* gravity = std::get_if<CameraGravityConstraint>(&constraint.what);
    if (gravity == nullptr) continue;
    const std::string where = constraint.where.empty() ? "constraint" : constraint.where;
    std::string names;
    for (const RigCamera& camera : observations.cameras) names += (names.empty() ? "" : ", ") + camera.name;
    if (std::ranges::find(observations.cameras, gravity->camera, &RigCamera::name) ==
        observations.cameras.end())
      throw invalid_input(where, fmt::format("{}: camera '{}' is not in the camera file; it has {}",
                                             title_of(constraint), gravity->camera, names));
    if (std::ranges::any_of(observations.views,
                            [&](const TagView& view) { return is_of(*gravity, view, observations); }))
      continue;
    throw invalid_input(
        where,
        fmt::format("{}: timestamp_ns: {} shows no tag at that time; frames with tags run from {} to {}",
                    title_of(constraint), gravity->camera,
                    observations.frames.empty() ? 0 : observations.frames.front().ns,
                    observations.frames.empty() ? 0 : observations.frames.back().ns));
  }
}

std::vector<MapConstraint> with_gravity_of_tags(const std::vector<MapConstraint>& constraints,
                                                const Observations& observations,
                                                const std::vector<std::size_t>& used,
                                                const std::vector<LinearView>& views, const MapState& state,
                                                double noise_variance) {
  std::vector<MapConstraint> result = constraints;
  for (MapConstraint& constraint : result) {
    const auto* gravity = std::get_if<CameraGravityConstraint>(&constraint.what);
    if (gravity == nullptr) continue;
    const TagView* largest = nullptr;
    for (const std::size_t v : used) {
      const TagView& view = observations.views[v];
      if (is_of(*gravity, view, observations) &&
          (largest == nullptr || mean_edge_px(view.corners_px) > mean_edge_px(largest->corners_px)))
        largest = &view;
    }
    if (largest == nullptr) continue;
    const auto variance = orientation_variance(views, largest->frame);
    if (!variance) continue;
    const auto tag = static_cast<std::size_t>(largest->tag);
    const Pose T_tag_camera = state.T_map_tag[tag].inverse() *
                              state.T_map_rig[static_cast<std::size_t>(largest->frame)] *
                              state.cameras[static_cast<std::size_t>(largest->camera)].T_camera_rig.inverse();
    const double sigma_rad = std::hypot(gravity->sigma_rad, std::sqrt(noise_variance * *variance));
    constraint.what = GravityConstraint{observations.tags[tag],
                                        T_tag_camera.rotation() * gravity->direction_camera, sigma_rad};
  }
  return result;
}

}  // namespace apriltrack
