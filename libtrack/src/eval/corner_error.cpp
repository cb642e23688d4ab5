#include "apriltrack/eval/corner_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apriltrack/base/check.h"
#include "apriltrack/geometry/tag_view.h"

namespace apriltrack {
namespace {

constexpr double kMinVisibleDepth_m = 0.02;
constexpr double kMinEstimatedDepth_m = 0.01;
constexpr double kMaxViewAngle_rad = 80.0 * std::numbers::pi / 180.0;

/// NaN, where a pole of the polynomial is hit, counts as the largest error too.
double capped_distance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double distance = (a - b).norm();
  return distance < kMaxCornerError_px ? distance : kMaxCornerError_px;
}

bool is_visible(const CornerScene& scene, const MapTag& tag,
                const std::array<Eigen::Vector3d, 4>& corners_map, const Pose& T_camera_map) {
  const auto depth = [&](const Eigen::Vector3d& corner_map) { return (T_camera_map * corner_map).z(); };
  const bool is_before_camera = std::ranges::all_of(
      corners_map, [&](const auto& corner) { return depth(corner) > kMinVisibleDepth_m; });
  if (!is_before_camera) return false;
  const Pose T_camera_tag = T_camera_map * tag.T_map_tag;
  const Eigen::Vector3d& centre = T_camera_tag.translation();
  const Eigen::Vector2d pixel = project_continued(scene.camera.model, centre);
  const bool is_in_image = pixel.x() >= 0.0 && pixel.x() < scene.camera.width && pixel.y() >= 0.0 &&
                           pixel.y() < scene.camera.height;
  if (!is_in_image) return false;
  return tag_view_cosine(T_camera_tag) >= std::cos(kMaxViewAngle_rad);
}

}  // namespace

std::vector<VisibleTag> visible_tags(const CornerScene& scene, const Pose& T_camera_map) {
  std::vector<VisibleTag> visible;
  for (const MapTag& tag : scene.map.tags) {
    const auto corners_map = corners_in_map(tag);
    if (is_visible(scene, tag, corners_map, T_camera_map)) visible.push_back({tag.key, corners_map});
  }
  return visible;
}

double mean_corner_error_px(const CornerScene& scene, const std::vector<VisibleTag>& tags,
                            const Pose& T_camera_map_truth, const Pose& T_camera_map_estimate) {
  APRILTRACK_CHECK(!tags.empty(), "a corner error is over at least one visible tag");
  const CameraModel& model = scene.camera.model;
  double sum = 0.0;
  for (const VisibleTag& tag : tags) {
    const bool is_before_camera =
        std::ranges::all_of(tag.corners_map, [&](const Eigen::Vector3d& corner_map) {
          return (T_camera_map_estimate * corner_map).z() > kMinEstimatedDepth_m;
        });
    for (const Eigen::Vector3d& corner_map : tag.corners_map) {
      sum += is_before_camera ? capped_distance(project_continued(model, T_camera_map_truth * corner_map),
                                                project_continued(model, T_camera_map_estimate * corner_map))
                              : kMaxCornerError_px;
    }
  }
  return sum / (4.0 * static_cast<double>(tags.size()));
}

double longest_corner_path_px(const CornerScene& scene, const std::vector<VisibleTag>& tags,
                              const Pose& T_camera_map_middle, const Pose& T_camera_map_end) {
  double longest = 0.0;
  for (const VisibleTag& tag : tags) {
    for (const Eigen::Vector3d& corner_map : tag.corners_map) {
      const Eigen::Vector2d half_path =
          project_continued(scene.camera.model, T_camera_map_end * corner_map) -
          project_continued(scene.camera.model, T_camera_map_middle * corner_map);
      longest = std::max(longest, 2.0 * half_path.norm());
    }
  }
  return longest;
}

}  // namespace apriltrack
