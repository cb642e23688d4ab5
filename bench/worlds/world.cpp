#include "world.h"

#include <algorithm>
#include <array>
#include <memory>

#include "apriltrack/base/error.h"
#include "draw.h"
#include "places.h"
#include "room_painter.h"
#include "truth.h"

namespace apriltrack::worlds {
namespace {

constexpr std::array<std::pair<WorldKind, std::string_view>, 5> kKinds = {{{WorldKind::kRoom, "room"},
                                                                           {WorldKind::kCorridor, "corridor"},
                                                                           {WorldKind::kHall, "hall"},
                                                                           {WorldKind::kDesk, "desk"},
                                                                           {WorldKind::kBody, "body"}}};
constexpr double kKindWeights[] = {0.30, 0.20, 0.20, 0.15, 0.15};
constexpr std::array<std::pair<FaultKind, std::string_view>, 8> kFaults = {
    {{FaultKind::kNone, "none"},
     {FaultKind::kWrongSize, "wrong_size"},
     {FaultKind::kMoved, "moved"},
     {FaultKind::kBent, "bent"},
     {FaultKind::kDuplicate, "duplicate"},
     {FaultKind::kLoose, "loose"},
     {FaultKind::kFocalLength, "focal"},
     {FaultKind::kCameraFile, "camera_file"}}};
constexpr std::uint64_t kMostAttempts = 60;
constexpr std::size_t kLeastJoined = 4;
constexpr double kLeastShareJoined = 0.6;

/// Worlds are drawn until frames join most of their tags. Tags that no frame shows stay: they hang there all
/// the same.
bool is_joined(const World& world) {
  const std::size_t joined = joined_tags(world, all_views(world)).size();
  return joined >= kLeastJoined &&
         static_cast<double>(joined) >= kLeastShareJoined * static_cast<double>(world.tags.size());
}

MapTag map_tag(const PlacedTag& placed, const Pose& T_map_tag) {
  MapTag tag;
  tag.key = placed.key;
  tag.size_m = placed.size_m;
  tag.T_map_tag = T_map_tag;
  return tag;
}

/// The tags of which the map tells, in its frame.
TagMap true_map(const World& world) {
  const bool is_body = world.scene.truth == TruthKind::kJoint;
  TagMap map;
  map.frame = is_body ? "body" : "world";
  map.default_family = world.tags.front().key.family;
  for (const PlacedTag& tag : world.tags) {
    if (tag.is_copy) continue;
    map.tags.push_back(map_tag(tag, is_body ? tag.T_body_tag : world.T_world_tag(tag, 0.0)));
  }
  return map;
}

std::optional<World> attempt_at(std::uint64_t seed, FaultKind fault, std::uint64_t attempt) {
  World world;
  world.seed = seed;
  world.fault = fault;
  Draw draw(seed, Part::kKind);
  world.kind = kKinds[draw.weighted(kKindWeights)].first;
  draw_surroundings(world, attempt);
  draw_lens(world, attempt);
  draw_tags(world, attempt);
  if (world.tags.size() < kLeastJoined || !draw_motion(world, attempt)) return std::nullopt;
  draw_light(world, attempt);
  draw_disturbances(world, attempt);
  draw_sensor(world, attempt);
  if (!is_joined(world)) return std::nullopt;
  for (const PlacedTag& tag : world.tags) world.stated_sizes_m[tag.key] = tag.size_m;
  world.stated_camera = world.scene.camera;
  if (!plant_fault(world, attempt)) return std::nullopt;
  world.drawn["attempt"] = attempt;
  return world;
}

}  // namespace

std::string_view to_string(WorldKind kind) {
  return std::ranges::find(kKinds, kind, &std::pair<WorldKind, std::string_view>::first)->second;
}

std::string_view to_string(FaultKind kind) {
  return std::ranges::find(kFaults, kind, &std::pair<FaultKind, std::string_view>::first)->second;
}

std::optional<FaultKind> parse_fault(std::string_view name) {
  const auto found = std::ranges::find(kFaults, name, &std::pair<FaultKind, std::string_view>::second);
  return found == kFaults.end() ? std::nullopt : std::optional(found->first);
}

Pose World::T_world_tag(const PlacedTag& tag, double time_s) const {
  return scene.T_world_body(scene.bodies[tag.body], time_s) * tag.T_body_tag;
}

void finish(World& world) {
  Scene& scene = world.scene;
  scene.map = true_map(world);
  const nlohmann::json& drawn = world.drawn["disturbances"];
  for (const PlacedTag& tag : world.tags) {
    const MapTag printed = map_tag(tag, tag.T_body_tag);
    if (tag.bend) {
      Body sheet{.name = "bent print", .T_world_body = scene.bodies[tag.body].T_world_body, .panels = {}};
      add_bent_tag(sheet, printed, *tag.bend, world.print);
      scene.bodies.push_back(sheet);
      continue;
    }
    TagMap one;
    one.default_family = tag.key.family;
    one.tags = {printed};
    Body& body = scene.bodies[tag.body];
    add_tags(body, one, world.print);
    body.panels.back().gloss = drawn["gloss"].get<double>();
    body.panels.back().gloss_width_rad = drawn["gloss_width_rad"].get<double>();
  }
  // Walls are painted for rooms up to 6 m; halls are seen from farther away, and take coarser texels.
  constexpr double kFine_m = 0.004, kCoarse_m = 0.008, kLarge_m = 6.0;
  const double texel_m = world.room_size_m.maxCoeff() > kLarge_m ? kCoarse_m : kFine_m;
  scene.room = paint_room({.min_corner = Eigen::Vector3d::Zero(),
                           .max_corner = world.room_size_m,
                           .texel_m = texel_m,
                           .seed = world.seed},
                          scene.lighting);
}

World make_world(std::uint64_t seed, FaultKind fault) {
  for (std::uint64_t attempt = 0; attempt < kMostAttempts; ++attempt) {
    if (std::optional<World> world = attempt_at(seed, fault, attempt)) {
      finish(*world);
      return *std::move(world);
    }
  }
  throw no_result("make_world", "no world was found for seed " + std::to_string(seed));
}

}  // namespace apriltrack::worlds
