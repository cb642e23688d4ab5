#include "apriltrack/photometric/photometric_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/photometric/patch.h"
#include "photometric_scratch.h"
#include "view_cone.h"

namespace apriltrack {
namespace {

/// In the middle of the image. Under lens and pixel (0.58 px) stripes of cells so narrow keep 3 % of their
/// contrast; codes are read from 1.2 px on.
constexpr double kLeastCell_px = 0.7;

/// What the tags of a family have in common: the mean of many.
TagPattern mean_pattern(const TagFamily& family) {
  constexpr int kMany = 300;
  const int step = std::max(1, family.num_codes() / kMany);
  const TagPattern first = family.pattern(0);
  Image<float> sum(first.cells().width(), first.cells().height());
  int count = 0;
  for (int id = 0; id < family.num_codes(); id += step) {
    const TagPattern pattern = family.pattern(id);
    for (int y = 0; y < sum.height(); ++y) {
      for (int x = 0; x < sum.width(); ++x) sum(x, y) += pattern.cells()(x, y);
    }
    ++count;
  }
  for (int y = 0; y < sum.height(); ++y) {
    for (int x = 0; x < sum.width(); ++x) sum(x, y) /= static_cast<float>(count);
  }
  return {std::move(sum), first.width_at_border()};
}

std::vector<TagPattern> patterns_of(const TagMap& map) {
  std::vector<TagPattern> patterns;
  for (const MapTag& tag : map.tags) {
    const TagFamily& family = TagFamily::get(tag.key.family);
    if (tag.key.id < 0 || tag.key.id >= family.num_codes()) {
      throw invalid_input("map", fmt::format("tag {}: family {} has ids 0 to {}", tag.key.id, tag.key.family,
                                             family.num_codes() - 1));
    }
    patterns.push_back(family.pattern(tag.key.id));
  }
  std::map<std::string, TagPattern> means;
  for (const MapTag& tag : map.tags) {
    if (!means.contains(tag.key.family))
      means.emplace(tag.key.family, mean_pattern(TagFamily::get(tag.key.family)));
    patterns.push_back(means.at(tag.key.family));
  }
  return patterns;
}

}  // namespace

PhotometricWorld::PhotometricWorld(const Camera& camera, const TagMap& map, TrackMode track_mode, int width,
                                   int height)
    : model(camera.model),
      mode(track_mode),
      rays(camera.model, 0, 0, kNumLevels),
      index(map),
      textures(patterns_of(map)) {
  if (width > 0 && height > 0) fit_size(width, height);
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    const MapTag& tag = map.tags[i];
    const TagPattern& pattern = textures.pattern(i);
    const double cell_m = 0.5 * tag.size_m * pattern.cell_size();
    tags.push_back({tag, i, pattern.half_extent(), camera_from_tag_plane(tag.T_map_tag, tag.size_m),
                    tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ(),
                    focal_px() * cell_m / kLeastCell_px});
  }
  scratch = std::make_unique<PhotometricScratch>(tags);
}

PhotometricWorld::~PhotometricWorld() = default;
PhotometricWorld::PhotometricWorld(PhotometricWorld&&) noexcept = default;
PhotometricWorld& PhotometricWorld::operator=(PhotometricWorld&&) noexcept = default;

void PhotometricWorld::fit_size(int width, int height) {
  rays = PixelRays(model, width, height, kNumLevels);
  max_view_angle_rad = apriltrack::max_view_angle_rad(model, width, height);
}

std::vector<std::size_t> PhotometricWorld::tags_in_sight(const MotionState& state) {
  const ViewPath path(state, 0.0, mode);
  const MapView& view = path.middle();
  std::vector<std::size_t> in_sight;
  for (const std::uint32_t k : scratch->nearby.of_path(path, max_view_angle_rad)) {
    const PhotometricTag& tag = tags[k];
    const Eigen::Vector3d centre = view.of_plane(tag.map_from_plane).col(2);
    if (is_front_in_sight(tag, view) && may_be_in_view(centre, tag.radius_m(), max_view_angle_rad))
      in_sight.push_back(k);
  }
  return in_sight;
}

}  // namespace apriltrack
