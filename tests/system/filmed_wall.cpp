#include "filmed_wall.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/tags/tag_corners.h"

namespace apriltrack::test {

std::string pinhole_entry(const std::string& name, double focal_px) {
  return fmt::format(
      "{0}:\n  camera_model: pinhole\n  intrinsics: [{1:.1f}, {1:.1f}, 319.5, 239.5]\n  distortion_model: "
      "none\n  distortion_coeffs: []\n  resolution: [640, 480]\n",
      name, focal_px);
}

Pose camera_from_wall(int view) {
  const double angle = 0.9 * view;
  Vector6d tilt = Vector6d::Zero();
  tilt.tail<3>() = Eigen::Vector3d(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0.1 * view);
  return Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-0.1, -0.05, 1.5)) * Pose::exp(tilt);
}

std::string wall_row(long long time_ns, const Pose& T_camera_wall, int id, const std::string& camera,
                     double focal_px) {
  std::string row = fmt::format("{},{},tag36h11,{}", time_ns, camera, id);
  for (const Eigen::Vector3d& corner_tag : tag_corners(0.16)) {
    const Eigen::Vector3d p = T_camera_wall * (kWallPlaces_m.at(id) + corner_tag);
    row += fmt::format(",{:.6f},{:.6f}", focal_px * p.x() / p.z() + 319.5, focal_px * p.y() / p.z() + 239.5);
  }
  return row + "\n";
}

void expect_distances_of_wall(const TagMap& map) {
  constexpr double kMaxError_m = 1e-4;  // the corners are exact to 1e-6 px
  for (const MapTag& a : map.tags) {
    for (const MapTag& b : map.tags) {
      EXPECT_NEAR((a.T_map_tag.translation() - b.T_map_tag.translation()).norm(),
                  (kWallPlaces_m.at(a.key.id) - kWallPlaces_m.at(b.key.id)).norm(), kMaxError_m)
          << a.key.id << " " << b.key.id;
    }
  }
}

}  // namespace apriltrack::test
