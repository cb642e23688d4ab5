#pragma once

#include <numbers>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/calib/calibrate_map.h"

namespace apriltrack::test {

/// Tags, cameras and a path with exact corners: the projection of the truth, to be disturbed by the test.
struct SyntheticWorld {
  TagMap map;
  CameraRig rig;
  std::vector<Pose> T_world_rig;

  TagSizes sizes() const;
};

inline constexpr int kImageWidth = 1000;
inline constexpr int kImageHeight = 800;

Camera perspective_camera(const std::string& name = "cam0");
Camera equidistant_camera(const std::string& name = "cam0");

/// A pose at `position` whose z axis points along `forward` and whose x axis is as level as can be (z of the
/// world is up): a camera that looks there, or a tag whose back faces there.
Pose looking_along(const Eigen::Vector3d& position, const Eigen::Vector3d& forward, double roll_rad = 0.0);

/// `num_tags` tags on the four walls of a 5 x 4 m room, and a camera that walks a circle and looks at the
/// walls.
SyntheticWorld make_room(int num_tags, int num_frames, const Camera& camera);

/// Two tags on walls that face each other, and one between them on the floor.
SyntheticWorld make_facing_walls();

/// Corners of every tag that a camera sees whole, from the front, at 75 degrees or less.
std::vector<FrameDetections> exact_detections(const SyntheticWorld& world);

/// Hangs up one more tag; its id is the number of those there before.
void add_tag(SyntheticWorld& world, double size_m, const Pose& T_map_tag);

/// Independent errors per coordinate.
void add_noise(std::vector<FrameDetections>& frames, double sigma_px, RandomStream& random);

/// The error normal to each edge at its ends is normal with `sigma_px`, and correlates between the ends of
/// one edge.
void add_edge_noise(std::vector<FrameDetections>& frames, double sigma_px, double end_correlation,
                    RandomStream& random);
/// The same, drawn once for each tag and kept in all of its views.
void add_edge_biases(std::vector<FrameDetections>& frames, double sigma_px, double end_correlation,
                     RandomStream& random);

/// Truth in the frame of `origin`, so that it can be held against a map with that tag held.
Pose T_origin_tag(const TagMap& truth, const TagKey& origin, const TagKey& tag);

}  // namespace apriltrack::test
