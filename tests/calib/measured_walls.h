#pragma once

#include "calibrating.h"

// A room whose tags' true places are known, and what somebody measured of them.

namespace apriltrack::test {

/// Ten tags on the walls of a room (ids 3, 5, ... 21), z up.
inline const SyntheticWorld& walls() {
  static const SyntheticWorld world = make_room(10, 24, equidistant_camera());
  return world;
}

inline std::vector<FrameDetections> noisy_frames(std::uint64_t trial) {
  auto frames = exact_detections(walls());
  RandomStream random(503, trial);
  add_edge_noise(frames, 0.15, -0.45, random);
  return frames;
}

inline const MapTag& true_tag(int id) {
  return *walls().map.find(tag36h11(id));
}

inline double true_distance_m(int a, int b) {
  return (true_tag(a).T_map_tag.translation() - true_tag(b).T_map_tag.translation()).norm();
}

inline const Eigen::Vector3d kNoError = Eigen::Vector3d::Zero();

inline MapConstraint position(int id, const Eigen::Vector3d& error_m, double sigma_m) {
  const Eigen::Vector3d p = true_tag(id).T_map_tag.translation() + error_m;
  return {.what = PositionConstraint{{"", id}, {p.x(), p.y(), p.z()}, sigma_m}};
}

inline MapConstraint distance(int a, int b, double error_m, double sigma_m) {
  return {.what = DistanceConstraint{{"", a}, {"", b}, true_distance_m(a, b) + error_m, sigma_m}};
}

inline MapConstraint gravity(int id, double sigma_rad) {
  const Eigen::Vector3d down = true_tag(id).T_map_tag.rotation().conjugate() * -Eigen::Vector3d::UnitZ();
  return {.what = GravityConstraint{{"", id}, down, sigma_rad}};
}

}  // namespace apriltrack::test
