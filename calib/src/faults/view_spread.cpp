#include "faults/view_spread.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

constexpr double kLeastSpread_rad = 0.1;

/// From the tag to the camera.
Eigen::Vector3d direction(const Pose& T_map_tag, const Pose& T_map_rig, const RigCamera& camera) {
  return (T_map_tag.inverse() * T_map_rig * camera.T_camera_rig.inverse()).translation().normalized();
}

bool are_from_one_side(const std::vector<Eigen::Vector3d>& directions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& one : directions) sum += one;
  const Eigen::Vector3d mean = sum.normalized();
  return std::ranges::all_of(
      directions, [&](const Eigen::Vector3d& one) { return one.dot(mean) >= std::cos(kLeastSpread_rad); });
}

}  // namespace

bool is_seen_from_one_side(const Observations& observations, const std::vector<std::size_t>& views,
                           const MapState& state, int tag) {
  std::vector<Eigen::Vector3d> directions;
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    if (view.tag == tag)
      directions.push_back(direction(state.T_map_tag[static_cast<std::size_t>(tag)],
                                     state.T_map_rig[static_cast<std::size_t>(view.frame)],
                                     state.cameras[static_cast<std::size_t>(view.camera)]));
  }
  return are_from_one_side(directions);
}

bool is_seen_from_one_side(const std::vector<ProbeView>& probes, const Pose& T_map_tag) {
  std::vector<Eigen::Vector3d> directions;
  for (const ProbeView& probe : probes)
    directions.push_back(direction(T_map_tag, probe.T_map_rig, *probe.camera));
  return are_from_one_side(directions);
}

}  // namespace apriltrack
