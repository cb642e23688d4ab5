#include "truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/tag_corners.h"
#include "apriltrack/geometry/tag_view.h"

namespace apriltrack::worlds {
namespace {

constexpr double kNearest_m = 0.02;
constexpr double kSteepestSeen_deg = 85.0;
constexpr double kBorder_px = 2.0;    // a tag nearer to the image's border is not whole
constexpr int kGrid = 7;              // points of the print, each way, that are asked for what hides them
constexpr double kSurface_m = 0.008;  // a print lies so near to its own surface, which does not hide it
constexpr int kLeastLinkFrames = 2;

struct Obstacle {
  Pose T_panel_world;
  Eigen::Vector2d half_size_m;
};

/// Panels that let no light through, at one moment; one side each, as the other side is another panel or is
/// inside.
std::vector<Obstacle> obstacles(const World& world, double time_s) {
  std::vector<Obstacle> all;
  for (const Body& body : world.scene.bodies) {
    const Pose T_world_body = world.scene.T_world_body(body, time_s);
    for (const Panel& panel : body.panels) {
      if (panel.is_decal || panel.opacity) continue;
      all.push_back({(T_world_body * panel.T_body_panel).inverse(), panel.half_size_m});
    }
  }
  return all;
}

bool hides(const Obstacle& panel, const Eigen::Vector3d& eye, const Eigen::Vector3d& point) {
  const Eigen::Vector3d from = panel.T_panel_world * eye;
  const Eigen::Vector3d to = panel.T_panel_world * point;
  if (from.z() >= 0.0 || to.z() <= 0.0) return false;  // not from its front to its back
  const double share = from.z() / (from.z() - to.z());
  if ((1.0 - share) * (to - from).norm() < kSurface_m) return false;
  const Eigen::Vector3d hit = from + share * (to - from);
  return std::abs(hit.x()) < panel.half_size_m.x() && std::abs(hit.y()) < panel.half_size_m.y();
}

Eigen::Vector3d point_of_tag(const PlacedTag& tag, double u_m, double v_m) {
  return tag.bend ? tag.bend->at(u_m, v_m) : Eigen::Vector3d(u_m, v_m, 0.0);
}

std::optional<std::array<Eigen::Vector2d, 4>> corners_seen(const Camera& camera, const Pose& T_camera_tag,
                                                           const PlacedTag& tag) {
  std::array<Eigen::Vector2d, 4> pixels;
  const auto corners = tag_corners(tag.size_m);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d point = T_camera_tag * point_of_tag(tag, corners[i].x(), corners[i].y());
    const auto pixel = point.z() > kNearest_m ? camera.model.project(point) : std::nullopt;
    if (!pixel) return std::nullopt;
    pixels[i] = *pixel;
  }
  return pixels;
}

bool is_inside(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel.x() > kBorder_px && pixel.y() > kBorder_px && pixel.x() < camera.width - 1 - kBorder_px &&
         pixel.y() < camera.height - 1 - kBorder_px;
}

double visible_fraction(const World& world, const std::vector<Obstacle>& before, const Pose& T_world_camera,
                        const Pose& T_world_tag, const PlacedTag& tag) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  const double half_m = 0.5 * tag.size_m * family.total_width() / family.width_at_border();
  const Pose T_camera_world = T_world_camera.inverse();
  int seen = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const double u = half_m * (2.0 * i / (kGrid - 1) - 1.0);
      const double v = half_m * (2.0 * j / (kGrid - 1) - 1.0);
      const Eigen::Vector3d point = T_world_tag * point_of_tag(tag, u, v);
      const Eigen::Vector3d point_camera = T_camera_world * point;
      const auto pixel =
          point_camera.z() > kNearest_m ? world.scene.camera.model.project(point_camera) : std::nullopt;
      if (!pixel || !is_inside(world.scene.camera, *pixel)) continue;
      const auto hides_it = [&](const Obstacle& one) {
        return hides(one, T_world_camera.translation(), point);
      };
      seen += tag.bend || std::ranges::none_of(before, hides_it) ? 1 : 0;  // a bent sheet is no solid
    }
  }
  return static_cast<double>(seen) / (kGrid * kGrid);
}

double longest_path(const std::array<Eigen::Vector2d, 4>& from, const std::array<Eigen::Vector2d, 4>& to) {
  double longest = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, (to[i] - from[i]).norm());
  return longest;
}

void set_sides(TrueView& view) {
  view.shortest_side_px = 1e9;
  for (std::size_t i = 0; i < 4; ++i) {
    const double side = (view.corners_px[i] - view.corners_px[(i + 1) % 4]).norm();
    view.mean_side_px += 0.25 * side;
    view.shortest_side_px = std::min(view.shortest_side_px, side);
  }
}

double blur_of(const World& world, const PlacedTag& tag, const std::array<Eigen::Vector2d, 4>& middle,
               double time_s) {
  double blur = 0.0;
  for (const double half : {-0.5, 0.5}) {
    const double t = time_s + half * world.scene.exposure_s;
    const auto end = corners_seen(
        world.scene.camera, world.scene.T_world_camera.at(t).inverse() * world.T_world_tag(tag, t), tag);
    if (end) blur += longest_path(middle, *end);
  }
  return blur;
}

}  // namespace

bool TrueView::is_good() const {
  return visible_fraction >= 1.0 && shortest_side_px >= kLeastSide_px && blur_px <= kMostBlur_px &&
         view_angle_rad < kSteepestView_deg * std::numbers::pi / 180.0;
}

std::vector<TrueView> views_from(const World& world, const Pose& T_world_camera, double time_s) {
  const Pose T_camera_world = T_world_camera.inverse();
  const std::vector<Obstacle> before = obstacles(world, time_s);
  std::vector<TrueView> views;
  for (std::size_t i = 0; i < world.tags.size(); ++i) {
    const PlacedTag& tag = world.tags[i];
    const Pose T_world_tag = world.T_world_tag(tag, time_s);
    const Pose T_camera_tag = T_camera_world * T_world_tag;
    const double cosine = tag_view_cosine(T_camera_tag);
    if (cosine < std::cos(kSteepestSeen_deg * std::numbers::pi / 180.0)) continue;
    const auto corners = corners_seen(world.scene.camera, T_camera_tag, tag);
    if (!corners || std::ranges::none_of(*corners, [&](const Eigen::Vector2d& corner) {
          return is_inside(world.scene.camera, corner);
        }))
      continue;
    TrueView view{.tag = i, .corners_px = *corners, .view_angle_rad = std::acos(std::min(cosine, 1.0))};
    set_sides(view);
    view.visible_fraction = visible_fraction(world, before, T_world_camera, T_world_tag, tag);
    views.push_back(view);
  }
  return views;
}

std::vector<TrueView> true_views(const World& world, double time_s) {
  std::vector<TrueView> views = views_from(world, world.scene.T_world_camera.at(time_s), time_s);
  for (TrueView& view : views) view.blur_px = blur_of(world, world.tags[view.tag], view.corners_px, time_s);
  return views;
}

std::vector<std::vector<TrueView>> all_views(const World& world) {
  std::vector<std::vector<TrueView>> frames;
  for (std::size_t i = 0; i < world.scene.num_frames; ++i)
    frames.push_back(true_views(world, seconds_between(Timestamp{}, world.scene.timestamp(i))));
  return frames;
}

std::vector<std::size_t> joined_tags(const World& world, const std::vector<std::vector<TrueView>>& frames) {
  const std::size_t count = world.tags.size();
  std::vector<int> links(count * count, 0);
  for (const auto& views : frames) {
    for (const TrueView& a : views) {
      for (const TrueView& b : views) links[a.tag * count + b.tag] += a.is_good() && b.is_good() ? 1 : 0;
    }
  }
  std::vector<std::size_t> largest;
  std::vector<bool> is_reached(count, false);
  for (std::size_t start = 0; start < count; ++start) {
    if (is_reached[start]) continue;
    std::vector<std::size_t> part = {start};
    is_reached[start] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (std::size_t other = 0; other < count; ++other) {
        if (is_reached[other] || links[part[i] * count + other] < kLeastLinkFrames) continue;
        is_reached[other] = true;
        part.push_back(other);
      }
    }
    if (part.size() > largest.size()) largest = part;
  }
  return largest;
}

}  // namespace apriltrack::worlds
