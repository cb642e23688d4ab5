#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack::test {

/// Where tags of 0.16 m truly are, on one wall.
inline const std::map<int, Eigen::Vector3d> kWallPlaces_m = {
    {0, {0.0, 0.0, 0.0}},    {1, {0.4, 0.0, 0.0}},    {2, {0.0, 0.3, 0.0}},
    {10, {-0.25, 0.0, 0.0}}, {11, {0.25, 0.0, 0.05}}, {20, {0.0, 0.0, 0.0}},
};

inline constexpr const char* kDetectionsHeader =
    "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n";

/// A camera file's entry of a pinhole of 640 x 480 pixels.
std::string pinhole_entry(const std::string& name, double focal_px = 500.0);

/// A walk round the wall, a step for every number.
Pose camera_from_wall(int view);

/// A row of a detection file: exact corners by the pinhole equation, which is all that the camera file says.
std::string wall_row(long long time_ns, const Pose& T_camera_wall, int id, const std::string& camera = "cam0",
                     double focal_px = 500.0);

/// The distances between all tags of a map are those of the wall.
void expect_distances_of_wall(const TagMap& map);

}  // namespace apriltrack::test
