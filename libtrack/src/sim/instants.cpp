#include <algorithm>
#include <cmath>

#include "film.h"

namespace apriltrack {
namespace {

constexpr int kPathSteps = 8;  // straight pieces of a path: bends within an exposure are slight
constexpr double kNearestPoint_m = 0.05;

/// Where the ray of the camera's middle-time pose meets the room.
Eigen::Vector3d hit_room(const Room& room, const Pose& T_world_camera, const Eigen::Vector3d& ray_camera) {
  const Eigen::Vector3d ray = T_world_camera.rotation() * ray_camera;
  const Eigen::Vector3d& eye = T_world_camera.translation();
  double depth = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(ray[axis]) < 1e-9) continue;
    const double wall = ray[axis] > 0.0 ? room.max_corner[axis] : room.min_corner[axis];
    depth = std::min(depth, (wall - eye[axis]) / ray[axis]);
  }
  return eye + depth * ray;
}

/// Points whose motion is followed: in the frame of the body that they belong to.
struct Followed {
  const Body* body = nullptr;  ///< Null: the room.
  std::vector<Eigen::Vector3d> points;
};

Followed points_of_room(const PreparedScene& prepared, double middle_s) {
  Followed followed;
  const Pose T_world_camera = prepared.scene->T_world_camera.at(middle_s);
  const std::vector<Tile>& tiles = prepared.grid.tiles();
  const std::size_t step = std::max<std::size_t>(1, tiles.size() / 50);
  for (std::size_t i = 0; i < tiles.size(); i += step) {
    const Eigen::Vector3d ray(tiles[i].centre.x(), tiles[i].centre.y(), 1.0);
    followed.points.push_back(hit_room(*prepared.scene->room, T_world_camera, ray));
  }
  return followed;
}

Followed points_of_body(const PreparedScene::PreparedBody& body) {
  Followed followed{.body = body.body, .points = {}};
  for (const PreparedPanel& panel : body.panels) {
    const Eigen::Vector2d& half = panel.panel->half_size_m;
    for (const double x : {-half.x(), half.x()}) {
      for (const double y : {-half.y(), half.y()}) {
        followed.points.push_back(panel.panel->T_body_panel * Eigen::Vector3d(x, y, 0.0));
      }
    }
  }
  return followed;
}

RayBounds view_bounds(const ViewGrid& grid) {
  RayBounds all = grid.tiles().empty() ? RayBounds{} : grid.tiles().front().bounds;
  for (const Tile& tile : grid.tiles()) {
    all.min_x = std::min(all.min_x, tile.bounds.min_x);
    all.max_x = std::max(all.max_x, tile.bounds.max_x);
    all.min_y = std::min(all.min_y, tile.bounds.min_y);
    all.max_y = std::max(all.max_y, tile.bounds.max_y);
  }
  return all;
}

/// Of a fisheye the pixel itself, for at 70 degrees off its axis a pinhole would show a path 8 times as long.
Eigen::Vector2d place_px(const CameraModel& lens, const Eigen::Vector3d& point_camera) {
  const Eigen::Vector2d ray = point_camera.head<2>() / point_camera.z();
  const bool is_fisheye = std::holds_alternative<EquidistantDistortion>(lens.distortion());
  const auto pixel = is_fisheye ? lens.project(point_camera) : std::nullopt;
  return pixel ? *pixel : Eigen::Vector2d(lens.pinhole().fx * ray.x(), lens.pinhole().fy * ray.y());
}

/// In pixels of the lens without its distortion; nullopt outside the view, grown by a quarter on each side.
/// Paths out there, wild where points pass the camera's own plane, are not seen.
std::optional<Eigen::Vector2d> pixel_near_view(const Eigen::Vector3d& point_camera, const CameraModel& lens,
                                               const RayBounds& view) {
  if (point_camera.z() < kNearestPoint_m) return std::nullopt;
  const Eigen::Vector2d ray = point_camera.head<2>() / point_camera.z();
  const double margin_x = 0.25 * (view.max_x - view.min_x);
  const double margin_y = 0.25 * (view.max_y - view.min_y);
  const bool is_near = ray.x() >= view.min_x - margin_x && ray.x() <= view.max_x + margin_x &&
                       ray.y() >= view.min_y - margin_y && ray.y() <= view.max_y + margin_y;
  return is_near ? std::optional(place_px(lens, point_camera)) : std::nullopt;
}

double longest_path_px(const PreparedScene& prepared, const Followed& followed, double middle_s,
                       double exposure_s) {
  const Scene& scene = *prepared.scene;
  const CameraModel& lens = scene.camera.model;
  const RayBounds view = view_bounds(prepared.grid);
  std::vector<double> paths(followed.points.size(), 0.0);
  std::vector<std::optional<Eigen::Vector2d>> last(followed.points.size());
  for (int step = 0; step <= kPathSteps; ++step) {
    const double t = middle_s + exposure_s * (static_cast<double>(step) / kPathSteps - 0.5);
    Pose T_camera_points = scene.T_world_camera.at(t).inverse();
    if (followed.body != nullptr) T_camera_points = T_camera_points * scene.T_world_body(*followed.body, t);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const Eigen::Vector3d point = T_camera_points * followed.points[i];
      const std::optional<Eigen::Vector2d> pixel = pixel_near_view(point, lens, view);
      if (pixel && last[i]) paths[i] += (*pixel - *last[i]).norm();
      last[i] = pixel;
    }
  }
  return paths.empty() ? 0.0 : *std::max_element(paths.begin(), paths.end());
}

}  // namespace

Instants choose_instants(const PreparedScene& prepared, double middle_s, double exposure_s,
                         const RenderOptions& options, int multiple_of) {
  if (exposure_s <= 0.0) return {.start_s = middle_s, .step_s = 0.0, .count = multiple_of};
  double path_px = 0.0;
  if (prepared.scene->room && !prepared.is_camera_fixed) {
    path_px = longest_path_px(prepared, points_of_room(prepared, middle_s), middle_s, exposure_s);
  }
  for (const auto& body : prepared.bodies) {
    if (prepared.is_camera_fixed && body.is_fixed) continue;
    path_px = std::max(path_px, longest_path_px(prepared, points_of_body(body), middle_s, exposure_s));
  }
  const double wanted = std::min(std::ceil(options.instants_per_px * path_px), 1.0 * options.max_instants);
  const int least = std::max(options.min_instants, static_cast<int>(wanted));
  const int count = (least + multiple_of - 1) / multiple_of * multiple_of * options.instants_factor;
  return {.start_s = middle_s - 0.5 * exposure_s, .step_s = exposure_s / count, .count = count};
}

}  // namespace apriltrack
