#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/sim/scene.h"

namespace apriltrack::worlds {

enum class WorldKind { kRoom, kCorridor, kHall, kDesk, kBody };
enum class FaultKind { kNone, kWrongSize, kMoved, kBent, kDuplicate, kLoose, kFocalLength, kCameraFile };

std::string_view to_string(WorldKind kind);
std::string_view to_string(FaultKind kind);
/// nullopt: there is no such fault.
std::optional<FaultKind> parse_fault(std::string_view name);

/// A flat place where tags hang. Frame as a tag's: x right, y down, z INTO the surface; origin in its middle.
struct Surface {
  std::string name;
  std::size_t body = 0;  ///< Index into the scene's bodies.
  Pose T_body_surface = {};
  Eigen::Vector2d half_size_m = Eigen::Vector2d::Zero();
  double weight = 1.0;  ///< How likely a tag is to hang there.
};

/// A tag as it really hangs.
struct PlacedTag {
  TagKey key;
  double size_m = 0.0;
  std::size_t body = 0;
  Pose T_body_tag = {};
  std::string surface = {};
  std::optional<Bend> bend = std::nullopt;
  bool is_copy = false;  ///< A second print of a key that the map has elsewhere.
};

/// A world with what a user says of it, which a planted fault makes wrong.
struct World {
  std::uint64_t seed = 0;
  WorldKind kind = WorldKind::kRoom;
  FaultKind fault = FaultKind::kNone;
  Scene scene;
  Eigen::Vector3d room_size_m = Eigen::Vector3d::Zero();  ///< From the origin to its far upper corner.
  std::vector<Surface> surfaces;
  std::vector<PlacedTag> tags;
  TagPrint print;
  std::map<TagKey, double> stated_sizes_m;
  Camera stated_camera = scene.camera;
  std::vector<TagKey> culprits;  ///< Tags with a fault.
  nlohmann::json drawn;          ///< Every drawn parameter, by part.

  Pose T_world_tag(const PlacedTag& tag, double time_s) const;
};

/// The same seed and fault give the same world, to the last bit. With a fault it is the clean world of that
/// seed, in which the fault is then planted; where it cannot be, another world is drawn.
World make_world(std::uint64_t seed, FaultKind fault);

/// Parts of make_world(), in their order. Each draws from a stream of its own.
void draw_surroundings(World& world, std::uint64_t attempt);
void draw_lens(World& world, std::uint64_t attempt);
void draw_tags(World& world, std::uint64_t attempt);
/// false: no path past the tags was found.
bool draw_motion(World& world, std::uint64_t attempt);
void draw_light(World& world, std::uint64_t attempt);
void draw_disturbances(World& world, std::uint64_t attempt);
void draw_sensor(World& world, std::uint64_t attempt);
/// false: there is no tag that the fault can be planted on.
bool plant_fault(World& world, std::uint64_t attempt);
/// Prints the tags, and paints the walls.
void finish(World& world);

}  // namespace apriltrack::worlds
