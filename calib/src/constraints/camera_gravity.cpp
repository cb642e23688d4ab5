#include "constraints/camera_gravity.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

bool is_of(const CameraGravityConstraint& gravity, const TagView& view, const Observations& observations) {
  return observations.cameras[static_cast<std::size_t>(view.camera)].name == gravity.camera &&
         observations.frames[static_cast<std::size_t>(view.frame)] == gravity.timestamp;
}

/// Variance of a frame's orientation, about its worst axis, the tags held: by the noise of its own views,
/// which repeat nobody's, and by what each tag keeps in all of its views.
std::optional<double> orientation_variance(const std::vector<LinearView>& views, int frame,
                                           const ErrorScale& scale) {
  Matrix6d information = Matrix6d::Zero();
  std::map<int, Eigen::Matrix<double, 6, 8>> by_errors;  // of the tags: of several cameras they add up
  for (const LinearView& view : views) {
    if (view.frame != frame) continue;
    information += view.by_rig.transpose() * view.by_rig;
    by_errors.try_emplace(view.tag, Eigen::Matrix<double, 6, 8>::Zero()).first->second +=
        view.by_rig.transpose() * view.by_error;
  }
  const Eigen::LDLT<Matrix6d> factor(information);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return std::nullopt;
  Matrix6d covariance =
      scale.noise_variance / scale.views_per_independent_view * factor.solve(Matrix6d::Identity());
  for (const auto& [tag, errors] : by_errors) {
    const Eigen::Matrix<double, 6, 8> followed = factor.solve(errors);
    covariance += scale.bias_variance * followed * followed.transpose();
  }
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
                                                const ErrorScale& scale) {
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
    const auto variance = orientation_variance(views, largest->frame, scale);
    if (!variance) continue;
    const auto tag = static_cast<std::size_t>(largest->tag);
    const Pose T_tag_camera = state.T_map_tag[tag].inverse() *
                              state.T_map_rig[static_cast<std::size_t>(largest->frame)] *
                              state.cameras[static_cast<std::size_t>(largest->camera)].T_camera_rig.inverse();
    const double sigma_rad = std::hypot(gravity->sigma_rad, std::sqrt(*variance));
    constraint.what =
        GravityConstraint{observations.tags[tag],
                          T_tag_camera.rotation() * gravity->direction_camera.stableNormalized(), sigma_rad};
  }
  return result;
}

}  // namespace apriltrack
