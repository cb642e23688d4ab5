#include "drawing_order.h"

#include <algorithm>
#include <numeric>

namespace apriltrack {
namespace {

constexpr double kTouching_m = 0.005;  // bodies that stand on each other are parted by the plane between them

struct Plane {
  Eigen::Vector3d point;
  Eigen::Vector3d outward;

  double distance(const Eigen::Vector3d& p) const { return outward.dot(p - point); }
};

/// A body in the camera's frame: the eye is the origin.
struct SeenBody {
  std::vector<Plane> planes;
  std::vector<Eigen::Vector3d> corners;
  double distance = 0.0;
};

SeenBody see_body(const PreparedScene::PreparedBody& body, const Pose& T_camera_body) {
  SeenBody seen;
  seen.distance = body.lies_on_walls ? 1e9 : (T_camera_body * body.centre_body).norm();
  for (const Panel& panel : body.body->panels) {
    if (panel.is_decal) continue;  // within the side that it lies on
    const Pose T_camera_panel = T_camera_body * panel.T_body_panel;
    seen.planes.push_back(
        {T_camera_panel.translation(), -(T_camera_panel.rotation() * Eigen::Vector3d::UnitZ())});
    for (const double x : {-panel.half_size_m.x(), panel.half_size_m.x()}) {
      for (const double y : {-panel.half_size_m.y(), panel.half_size_m.y()})
        seen.corners.push_back(T_camera_panel * Eigen::Vector3d(x, y, 0.0));
    }
  }
  return seen;
}

/// 1: a plane of `a` parts them and the eye is on the side of b, which may hide a; -1: on the side of a; 0:
/// none does.
int side_of_eye(const SeenBody& a, const SeenBody& b) {
  for (const Plane& plane : a.planes) {
    const auto is_outside = [&](const Eigen::Vector3d& p) { return plane.distance(p) > -kTouching_m; };
    const auto is_inside = [&](const Eigen::Vector3d& p) { return plane.distance(p) < kTouching_m; };
    if (std::ranges::all_of(b.corners, is_outside) && std::ranges::all_of(a.corners, is_inside))
      return plane.distance(Eigen::Vector3d::Zero()) > 0.0 ? 1 : -1;
  }
  return 0;
}

bool may_hide(const SeenBody& front, const SeenBody& back) {
  const int by_back = side_of_eye(back, front);
  return by_back != 0 ? by_back > 0 : side_of_eye(front, back) < 0;
}

}  // namespace

std::vector<std::size_t> drawing_order(const PreparedScene& prepared, double time_s) {
  const Pose T_camera_world = prepared.scene->T_world_camera.at(time_s).inverse();
  std::vector<SeenBody> seen;
  for (const auto& body : prepared.bodies)
    seen.push_back(see_body(body, T_camera_world * prepared.scene->T_world_body(*body.body, time_s)));

  std::vector<std::size_t> left(seen.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::ranges::stable_sort(left,
                           [&](std::size_t a, std::size_t b) { return seen[a].distance > seen[b].distance; });
  std::vector<std::size_t> order;
  while (!left.empty()) {  // the farthest that hides none of the others; of a circle, the farthest
    const auto hides_none = [&](std::size_t one) {
      return prepared.bodies[one].lies_on_walls || std::ranges::none_of(left, [&](std::size_t other) {
               return other != one && may_hide(seen[one], seen[other]);
             });
    };
    auto next = std::ranges::find_if(left, hides_none);
    if (next == left.end()) next = left.begin();
    order.push_back(*next);
    left.erase(next);
  }
  return order;
}

}  // namespace apriltrack
