#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// What a pose is for: seeing tags through a camera. Corner errors are measured in this camera's raw pixels.
struct CornerScene {
  Camera camera;  ///< With a resolution.
  TagMap map;
};

/// Error of one frame in which nothing fits: points behind the camera, or farther off than this.
inline constexpr double kMaxCornerError_px = 1e4;

/// A tag that the true pose shows.
struct VisibleTag {
  TagKey key;
  std::array<Eigen::Vector3d, 4> corners_map;  ///< In corner order, metres.
};

/// Tags whose centre lies in the image, that face the camera by less than 80 degrees from the line of sight,
/// and whose corners all lie over 2 cm before it.
std::vector<VisibleTag> visible_tags(const CornerScene& scene, const Pose& T_camera_map);

/// Mean distance, in pixels, of the tags' corners projected with both poses; each at most kMaxCornerError_px,
/// which is also the distance of a tag of which the estimate puts a corner nearer than 1 cm or behind the
/// camera. Requires at least one tag.
double mean_corner_error_px(const CornerScene& scene, const std::vector<VisibleTag>& tags,
                            const Pose& T_camera_map_truth, const Pose& T_camera_map_estimate);

/// The longest path of a corner during the exposure: twice its way from mid-exposure to the end.
double longest_corner_path_px(const CornerScene& scene, const std::vector<VisibleTag>& tags,
                              const Pose& T_camera_map_middle, const Pose& T_camera_map_end);

}  // namespace apriltrack
