#include "apriltrack/report/map_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/degrees.h"
#include "apriltrack/report/lengths.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

enum MapSceneState : std::size_t { kInMap, kHeld, kFlagged };

MapSceneState state_of(const MapTag& tag) {
  if (tag.statistics && !tag.statistics->flags.empty()) return kFlagged;
  return is_held(tag) ? kHeld : kInMap;
}

}  // namespace

ScenePose scene_pose(const Pose& T_scene_thing) {
  return {T_scene_thing.translation(), T_scene_thing.rotation()};
}

std::string short_name(const TagMap& map, const MapTag& tag) {
  const bool is_one_family = std::ranges::all_of(
      map.tags, [&](const MapTag& other) { return other.key.family == map.tags.front().key.family; });
  return is_one_family ? fmt::format("{}", tag.key.id) : to_string(tag.key);
}

double position_sigma_m(const Matrix6d& covariance) {
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
}

double rotation_sigma_rad(const Matrix6d& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
}

Eigen::Matrix3d position_covariance(const MapTag& tag) {
  const Eigen::Matrix3d R_map_tag = tag.T_map_tag.rotation_matrix();
  return R_map_tag * tag.covariance->topLeftCorner<3, 3>() * R_map_tag.transpose();
}

bool is_held(const MapTag& tag) {
  return tag.covariance && tag.covariance->isZero();
}

std::vector<std::string> notes_of(const MapTag& tag) {
  const Eigen::Vector3d& p = tag.T_map_tag.translation();
  std::vector<std::string> notes = {fmt::format("size {}", length_in_words(tag.size_m)),
                                    fmt::format("at x {}, y {}, z {}", length_in_words(p.x()),
                                                length_in_words(p.y()), length_in_words(p.z()))};
  if (tag.covariance && !is_held(tag))
    notes.push_back(fmt::format("sigma {} and {:.3f} degrees",
                                length_in_words(position_sigma_m(*tag.covariance)),
                                kDegPerRad * rotation_sigma_rad(*tag.covariance)));
  if (tag.statistics) {
    notes.push_back(
        fmt::format("{} views, residual {:.3f} px", tag.statistics->views, tag.statistics->residual_rms_px));
    if (!tag.statistics->flags.empty())
      notes.push_back(fmt::format("{}", fmt::join(tag.statistics->flags, ", ")));
  }
  return notes;
}

SceneTag scene_tag(const TagMap& map, const MapTag& tag, std::size_t state) {
  const TagFamily& family = TagFamily::get(tag.key.family);
  SceneTag drawn{.name = to_string(tag.key),
                 .label = short_name(map, tag),
                 .notes = notes_of(tag),
                 .pose = scene_pose(tag.T_map_tag),
                 .size_m = tag.size_m,
                 .family = tag.key.family,
                 .cells = family.pattern(tag.key.id).cells(),
                 .width_at_border = family.width_at_border(),
                 .state = state};
  if (tag.covariance && !is_held(tag)) drawn.covariance_m2 = position_covariance(tag);
  return drawn;
}

SceneView scene_of_map(const TagMap& map, const Eigen::Vector3d& up, double ellipsoid_scale) {
  SceneView scene{
      .up = up,
      .tag_states = {{"of the map", SvgInk::kText}, {"held", SvgInk::kGood}, {"flagged", SvgInk::kWarning}},
      .ellipsoid_scale = ellipsoid_scale};
  for (const MapTag& tag : map.tags) scene.tags.push_back(scene_tag(map, tag, state_of(tag)));
  return scene;
}

}  // namespace apriltrack
