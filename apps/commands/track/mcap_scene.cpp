#include "mcap_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/report/colour.h"

namespace apriltrack::app {
namespace {

constexpr double kTagOpacity = 0.75;
constexpr double kLetterShare = 0.35;  // of a tag's edge
constexpr SceneColour kMapColour{0.6, 0.6, 0.6, 1.0};
constexpr SceneColour kPathColour{0.0, 0.45, 0.7, 1.0};
constexpr SceneColour kCameraColour{0.9, 0.6, 0.0, 1.0};

SceneColour scene_colour(const Colour& colour) {
  constexpr double kWhite = 255.0;
  return {colour.red / kWhite, colour.green / kWhite, colour.blue / kWhite, 1.0};
}

double median_size_m(const TagMap& map) {
  std::vector<double> sizes_m;
  for (const MapTag& tag : map.tags) sizes_m.push_back(tag.size_m);
  const auto middle = sizes_m.begin() + static_cast<std::ptrdiff_t>(sizes_m.size() / 2);
  std::nth_element(sizes_m.begin(), middle, sizes_m.end());
  return *middle;
}

}  // namespace

SceneColour colour_of(SightStatus status) {
  switch (status) {
    case SightStatus::kDetected:
      return scene_colour(kBluishGreen);
    case SightStatus::kTracked:
      return scene_colour(kSkyBlue);
    case SightStatus::kOccluded:
      return scene_colour(kOrange);
    case SightStatus::kHidden:
      return scene_colour(kYellow);
    case SightStatus::kElsewhere:
      return scene_colour(kVermilion);
    case SightStatus::kSuspect:
      return scene_colour(kReddishPurple);
    case SightStatus::kUnjudged:
    case SightStatus::kUnmapped:
      break;
  }
  return scene_colour(kPaleGrey);
}

SceneEntity map_entity(const TagMap& map, const std::string& frame) {
  SceneEntity entity{.frame = frame, .id = "map", .lines = {}, .quads = {}, .texts = {}, .facts = {}};
  entity.facts.emplace_back("tags", std::to_string(map.tags.size()));
  for (const MapTag& tag : map.tags) {
    const auto corners = corners_in_map(tag);
    entity.lines.push_back({{corners.begin(), corners.end()}, true, 1.5, kMapColour});
    entity.texts.push_back(
        {tag.T_map_tag.translation(), kLetterShare * tag.size_m, kMapColour, fmt::format("{}", tag.key.id)});
  }
  return entity;
}

SceneEntity sights_entity(std::span<const TagSight> sights, const TagMap& map, const std::string& frame) {
  SceneEntity entity{.frame = frame, .id = "tags", .lines = {}, .quads = {}, .texts = {}, .facts = {}};
  for (const TagSight& sight : sights) {
    const MapTag* tag = map.find(sight.tag);
    if (!tag) continue;
    SceneColour colour = colour_of(sight.status);
    colour.opacity = kTagOpacity;
    entity.quads.push_back({corners_in_map(*tag), colour});
    entity.facts.emplace_back(to_string(sight.tag), to_string(sight.status));
  }
  return entity;
}

std::optional<SceneEntity> frustum_entity(const Camera& camera, const TagMap& map, const std::string& frame) {
  constexpr double kDepthInSizes = 2.0;
  constexpr double kLeastForward = 0.05;
  if (camera.width <= 0 || camera.height <= 0) return std::nullopt;
  const double right = camera.width - 0.5, bottom = camera.height - 0.5;
  SceneLine edge{.points = {}, .is_closed = true, .width_px = 2.0, .colour = kCameraColour};
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}}) {
    const auto ray = camera.model.unproject({x, y});
    if (!ray || ray->z() < kLeastForward) return std::nullopt;
    edge.points.push_back(kDepthInSizes * median_size_m(map) / ray->z() * *ray);
  }
  SceneEntity entity{.frame = frame, .id = "frustum", .lines = {edge}, .quads = {}, .texts = {}, .facts = {}};
  for (const Eigen::Vector3d& corner : edge.points)
    entity.lines.push_back({{Eigen::Vector3d::Zero(), corner}, false, 2.0, kCameraColour});
  return entity;
}

std::vector<PictureOutline> sight_outlines(std::span<const TagSight> sights) {
  std::vector<PictureOutline> outlines;
  for (const TagSight& sight : sights) {
    if (!sight.projected_px) continue;
    outlines.push_back({{sight.projected_px->begin(), sight.projected_px->end()},
                        colour_of(sight.status),
                        fmt::format("{}", sight.tag.id)});
  }
  return outlines;
}

void PathSoFar::add(const Eigen::Vector3d& position) {
  constexpr std::size_t kMostPoints = 1000;
  last_ = position;
  if (num_added_++ % step_ != 0) return;
  points_.push_back(position);
  if (points_.size() < kMostPoints) return;
  for (std::size_t i = 0; 2 * i < points_.size(); ++i) points_[i] = points_[2 * i];
  points_.resize((points_.size() + 1) / 2);
  step_ *= 2;
}

SceneEntity PathSoFar::entity(const std::string& frame) const {
  SceneLine line{.points = points_, .is_closed = false, .width_px = 2.0, .colour = kPathColour};
  if (last_) line.points.push_back(*last_);
  return {.frame = frame, .id = "path", .lines = {line}, .quads = {}, .texts = {}, .facts = {}};
}

}  // namespace apriltrack::app
