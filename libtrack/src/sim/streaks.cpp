#include "apriltrack/sim/streaks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apriltrack/geometry/tag_view.h"

namespace apriltrack {
namespace {

constexpr double kNearest_m = 0.02;
constexpr double kSteepest_deg = 80.0;

/// nullopt when one of the corners lies behind the camera or outside the lens model.
std::optional<std::array<Eigen::Vector2d, 4>> project_corners(const Camera& camera, const Pose& T_camera_map,
                                                              const MapTag& tag) {
  std::array<Eigen::Vector2d, 4> pixels;
  const auto corners = corners_in_map(tag);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d point = T_camera_map * corners[i];
    const auto pixel = point.z() > kNearest_m ? camera.model.project(point) : std::nullopt;
    if (!pixel) return std::nullopt;
    pixels[i] = *pixel;
  }
  return pixels;
}

bool shows_its_face(const Camera& camera, const Pose& T_camera_tag) {
  const auto pixel = camera.model.project(T_camera_tag.translation());
  if (!pixel || (*pixel).x() < 0.0 || (*pixel).y() < 0.0 || (*pixel).x() >= camera.width ||
      (*pixel).y() >= camera.height) {
    return false;
  }
  return tag_view_cosine(T_camera_tag) >= std::cos(kSteepest_deg * std::numbers::pi / 180.0);
}

double longest_path(const std::array<Eigen::Vector2d, 4>& middle, const std::array<Eigen::Vector2d, 4>& end) {
  double longest = 0.0;
  for (std::size_t i = 0; i < middle.size(); ++i) longest = std::max(longest, (end[i] - middle[i]).norm());
  return longest;
}

}  // namespace

std::vector<TagView> tag_views(const Scene& scene, Timestamp middle) {
  const double t = seconds_between(Timestamp{}, middle);
  const Pose now = scene.T_camera_map(t);
  const std::array<Pose, 2> ends = {scene.T_camera_map(t - 0.5 * scene.exposure_s),
                                    scene.T_camera_map(t + 0.5 * scene.exposure_s)};
  std::vector<TagView> views;
  for (const MapTag& tag : scene.map.tags) {
    const auto corners = project_corners(scene.camera, now, tag);
    if (!corners || !shows_its_face(scene.camera, now * tag.T_map_tag)) continue;
    TagView view{.key = tag.key, .corners_px = *corners};
    for (const Pose& end : ends) {
      if (const auto moved = project_corners(scene.camera, end, tag))
        view.blur_px += longest_path(*corners, *moved);
    }
    views.push_back(view);
  }
  return views;
}

std::optional<double> frame_blur_px(const Scene& scene, Timestamp middle) {
  const std::vector<TagView> views = tag_views(scene, middle);
  const auto by_blur = [](const TagView& a, const TagView& b) { return a.blur_px < b.blur_px; };
  const auto longest = std::max_element(views.begin(), views.end(), by_blur);
  return longest == views.end() ? std::nullopt : std::optional(longest->blur_px);
}

}  // namespace apriltrack
