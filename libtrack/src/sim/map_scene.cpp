#include "apriltrack/sim/map_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "apriltrack/base/error.h"
#include "room_painter.h"

namespace apriltrack {
namespace {

constexpr double kUsualExposure_s = 0.016;
constexpr double kWallDistance_m = 0.6;   // the least, of walls from all that is in the room
constexpr double kFinestTexel_m = 0.003;  // as the named scenes have it
constexpr double kMostTexels = 3e7;       // of all walls together: 120 MB as floats

double half_card_m(const MapTag& tag, double margin_cells) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  return tag.size_m / family.width_at_border() * (0.5 * family.total_width() + margin_cells);
}

/// Cards as wide as the named scenes', unless tags are printed so close together that these would overlap.
TagPrint print_of(const TagMap& map) {
  const TagPrint usual;
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const MapTag& a = map.tags[i];
      const MapTag& b = map.tags[j];
      const double apart_m = (a.T_map_tag.translation() - b.T_map_tag.translation()).norm();
      const double reach_m = half_card_m(a, usual.margin_cells) + half_card_m(b, usual.margin_cells);
      if (apart_m < std::numbers::sqrt2 * reach_m) return {.margin_cells = 0.0};
    }
  }
  return usual;
}

/// A tag's card in its own frame: printed in front, plain behind.
Body card(const MapTag& tag, const TagPrint& print) {
  Body body{.name = to_string(tag.key), .T_world_body = {}, .panels = {}};
  add_plate(body, Pose(), Eigen::Vector2d::Constant(half_card_m(tag, print.margin_cells)), print.paper);
  MapTag at_origin = tag;
  at_origin.T_map_tag = Pose();
  TagMap alone;
  alone.default_family = tag.key.family;
  alone.tags = {at_origin};
  add_tags(body, alone, print);
  return body;
}

/// What the room must hold, and which way its cameras look up, in the world.
struct Surroundings {
  Eigen::AlignedBox3d box;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();  // of any length
};

std::vector<double> instants_of(const SampledPath& path) {
  constexpr int kInstants = 1000;
  std::vector<double> times_s;
  for (int i = 0; i <= kInstants; ++i)
    times_s.push_back(path.start_s() + (path.end_s() - path.start_s()) * i / kInstants);
  return times_s;
}

Surroundings surroundings(const MapSceneOptions& options) {
  Surroundings found;
  const auto add_tags_at = [&](const Pose& T_world_map) {
    for (const MapTag& tag : options.map.tags)
      for (const Eigen::Vector3d& corner : corners_in_map(tag)) found.box.extend(T_world_map * corner);
  };
  const bool is_ego = options.truth == TruthKind::kEgo;
  found.box.extend(Eigen::Vector3d::Zero());  // the map's origin, or the camera
  if (is_ego) add_tags_at(Pose());
  for (const double time_s : instants_of(options.path)) {
    const Pose pose = options.path.at(time_s);
    if (is_ego)
      found.box.extend(pose.translation());
    else
      add_tags_at(pose);
    found.up -=
        is_ego ? Eigen::Vector3d(pose.rotation() * Eigen::Vector3d::UnitY()) : Eigen::Vector3d::UnitY();
  }
  const Eigen::Vector3d wall =
      Eigen::Vector3d::Constant(std::max(kWallDistance_m, 0.1 * found.box.sizes().maxCoeff()));
  found.box.min() -= wall;
  found.box.max() += wall;
  return found;
}

/// As fine as the named scenes' walls, but of a hall no more texels than fit into memory.
double texel_of(const Eigen::Vector3d& size_m) {
  const double area_m2 = 2.0 * (size_m.x() * size_m.y() + size_m.y() * size_m.z() + size_m.z() * size_m.x());
  return std::max(kFinestTexel_m, std::sqrt(area_m2 / kMostTexels));
}

void build_room(Scene& scene, const Surroundings& around) {
  int up_axis = 2;
  around.up.cwiseAbs().maxCoeff(&up_axis);
  const double up_sign = around.up[up_axis] < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d size_m = around.box.sizes();
  Eigen::Vector3d lamp = around.box.center();
  lamp[up_axis] += up_sign * 0.45 * size_m[up_axis];
  scene.lighting = {.lamp_world = lamp, .ambient = 0.4, .intensity = 1.0, .reach_m = 0.5 * size_m.norm()};
  scene.room = paint_room({.min_corner = around.box.min(),
                           .max_corner = around.box.max(),
                           .up_axis = up_axis,
                           .up_sign = up_sign,
                           .texel_m = texel_of(size_m),
                           .seed = 4},
                          scene.lighting);
}

}  // namespace

Scene make_map_scene(const MapSceneOptions& options) {
  check_tag_map(options.map);
  Scene scene;
  scene.name = "map";
  scene.map = options.map;
  scene.camera = options.camera;
  scene.truth = options.truth;
  Motion motion;
  motion.path = std::make_shared<const SampledPath>(options.path);
  motion.speed = options.speed;
  const bool is_ego = options.truth == TruthKind::kEgo;
  scene.T_world_camera = is_ego ? motion : Motion::fixed(Pose());

  Body frame{
      .name = options.map.frame, .T_world_body = {}, .panels = {}};  // carries the map, and shows nothing
  if (!is_ego) frame.T_world_body = motion;
  scene.bodies = {frame};
  const TagPrint print = print_of(options.map);
  for (const MapTag& tag : options.map.tags) {
    Body sheet = card(tag, print);
    sheet.T_world_body = frame.T_world_body;
    sheet.T_world_body.T_end = tag.T_map_tag;
    scene.bodies.push_back(sheet);
  }
  build_room(scene, surroundings(options));
  scene.rate_hz = std::clamp(1.0 / options.path.median_step_s(), 0.01, 10000.0);
  scene.exposure_s = std::min(options.camera.exposure_s.value_or(kUsualExposure_s), 1.0 / scene.rate_hz);
  fit_to_path(scene);
  return scene;
}

void fit_to_path(Scene& scene) {
  const Motion& motion =
      scene.truth == TruthKind::kEgo ? scene.T_world_camera : scene.bodies[scene.truth_body].T_world_body;
  constexpr double kRounding = 1e-6;  // of a frame; times in text have nanoseconds
  const double speed =
      motion.speed > 0.0 ? motion.speed : 1.0;  // at rest, the film takes as long as the path
  const double start_s = motion.path->start_s() / speed;
  const double end_s = motion.path->end_s() / speed;
  const double first_s = start_s + 0.5 * scene.exposure_s;
  const double num_intervals =
      std::floor((end_s - 0.5 * scene.exposure_s - first_s) * scene.rate_hz + kRounding);
  if (num_intervals < 0.0)
    throw invalid_input("trajectory",
                        fmt::format("takes {:g} s at this speed, less than one exposure of {:g} s",
                                    end_s - start_s, scene.exposure_s));
  scene.start_ns = std::llround(first_s * 1e9);
  scene.num_frames = static_cast<std::size_t>(num_intervals) + 1;
}

}  // namespace apriltrack
