#include "assess/candidate_views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "apriltrack/base/degrees.h"

namespace apriltrack {
namespace {

constexpr double kBeyond_m = 0.5;  // of where the camera has been

using Box = Eigen::AlignedBox3d;

Box where_cameras_were(const MapEvidence& evidence) {
  Box box;
  for (const RigPose& moment : evidence.moments) box.extend(moment.T_map_rig.translation());
  if (box.isEmpty()) return box;
  const Eigen::Vector3d more = Eigen::Vector3d::Constant(kBeyond_m) + 0.2 * box.sizes();
  return {box.min() - more, box.max() + more};
}

std::vector<int> nearest_tags(const TagMap& map, int tag, std::size_t count) {
  const Eigen::Vector3d& here = map.tags[static_cast<std::size_t>(tag)].T_map_tag.translation();
  std::vector<int> others;
  for (int other = 0; other < static_cast<int>(map.tags.size()); ++other) {
    if (other != tag) others.push_back(other);
  }
  std::ranges::stable_sort(others, {}, [&](int other) {
    return (map.tags[static_cast<std::size_t>(other)].T_map_tag.translation() - here).squaredNorm();
  });
  others.resize(std::min(count, others.size()));
  return others;
}

/// At `position`, its optical axis through `target`, as upright as the tag hangs: its y axis along `down`.
Pose looking_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target, const Eigen::Vector3d& down) {
  Eigen::Matrix3d R;
  R.col(2) = (target - position).normalized();
  R.col(0) = down.cross(R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return {R, position};
}

/// From before the tag, in its frame (x right, y down, z into it).
Eigen::Vector3d place_before_tag(double distance_m, double aside_rad, double above_rad) {
  return distance_m * Eigen::Vector3d(std::sin(aside_rad) * std::cos(above_rad), -std::sin(above_rad),
                                      -std::cos(aside_rad) * std::cos(above_rad));
}

}  // namespace

std::vector<CandidateView> candidate_views(const TagMap& map, const MapEvidence& evidence,
                                           const Camera& camera, int tag, bool is_dense) {
  constexpr double kDenseAside[] = {-55, -30, 0, 30, 55}, kDenseAbove[] = {-25, 0, 25};
  constexpr double kSparseAside[] = {-40, 0, 40}, kSparseAbove[] = {0};
  constexpr double kDenseEdges_px[] = {120, 60, 35}, kSparseEdges_px[] = {70, 35};
  const auto choose = [&](std::span<const double> dense, std::span<const double> sparse) {
    return is_dense ? dense : sparse;
  };
  const Box box = where_cameras_were(evidence);
  const MapTag& own = map.tags[static_cast<std::size_t>(tag)];
  const Eigen::Vector3d down = own.T_map_tag.rotation() * Eigen::Vector3d::UnitY();
  std::vector<CandidateView> views;
  for (const int partner : nearest_tags(map, tag, is_dense ? 5 : 3)) {
    const Eigen::Vector3d middle =
        0.5 *
        (own.T_map_tag.translation() + map.tags[static_cast<std::size_t>(partner)].T_map_tag.translation());
    for (const double edge_px : choose(kDenseEdges_px, kSparseEdges_px)) {
      const double distance_m = camera.model.pinhole().fx * own.size_m / edge_px;
      for (const double aside : choose(kDenseAside, kSparseAside)) {
        for (const double above : choose(kDenseAbove, kSparseAbove)) {
          CandidateView view{tag, partner, distance_m, aside * kRadPerDeg, above * kRadPerDeg, {}};
          const Eigen::Vector3d position =
              own.T_map_tag * place_before_tag(distance_m, view.aside_rad, view.above_rad);
          if (!box.contains(position) || (middle - position).cross(down).norm() < 1e-6) continue;
          view.T_map_camera = looking_at(position, middle, down);
          views.push_back(view);
        }
      }
    }
  }
  return views;
}

}  // namespace apriltrack
