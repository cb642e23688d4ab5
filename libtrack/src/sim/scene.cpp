#include "apriltrack/sim/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apriltrack/base/check.h"

namespace apriltrack {

double Lighting::irradiance(const Eigen::Vector3d& point_world,
                            const Eigen::Vector3d& outward_normal_world) const {
  constexpr double kSoftness = 0.05;  // rounds the terminator, so that shading stays smooth as a body turns
  const Eigen::Vector3d to_lamp = lamp_world - point_world;
  const double distance = to_lamp.norm();
  const double cosine = outward_normal_world.dot(to_lamp) / std::max(distance, 1e-6);
  const double lit = 0.5 * (cosine + std::sqrt(cosine * cosine + kSoftness * kSoftness));
  return ambient + intensity * lit / (1.0 + distance * distance / (reach_m * reach_m));
}

double Flicker::light(double time_s) const {
  return 1.0 + depth * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s + phase_rad);
}

Timestamp Scene::timestamp(std::size_t index) const {
  return advance(Timestamp{start_ns}, static_cast<double>(index) / rate_hz);
}

bool Scene::is_blacked_out(std::size_t index) const {
  return std::ranges::any_of(blackouts, [index](const FrameSpan& dark) {
    return index >= dark.first && index - dark.first < dark.count;
  });
}

Pose Scene::T_world_body(const Body& body, double time_s) const {
  const Pose T_parent_body = body.T_world_body.at(time_s);
  return body.moves_with_camera ? T_world_camera.at(time_s) * T_parent_body : T_parent_body;
}

Pose Scene::T_camera_map(double time_s) const {
  APRILTRACK_CHECK(truth_body < bodies.size(), "truth_body must name one of the scene's bodies");
  return T_world_camera.at(time_s).inverse() * bodies[truth_body].T_world_body.at(time_s);
}

Pose Scene::truth_pose(Timestamp time) const {
  const Pose T = T_camera_map(seconds_between(Timestamp{}, time));
  return truth == TruthKind::kJoint ? T : T.inverse();
}

}  // namespace apriltrack
