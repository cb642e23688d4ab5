#include "apriltrack/photometric/photometric_world.h"

#include <fmt/format.h>

#include "apriltrack/base/error.h"
#include "apriltrack/photometric/patch.h"
#include "photometric_scratch.h"
#include "view_cone.h"

namespace apriltrack {
namespace {

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
  return patterns;
}

}  // namespace

PhotometricWorld::PhotometricWorld(const Camera& camera, const TagMap& map, TrackMode track_mode, int width,
                                   int height)
    : model(camera.model),
      mode(track_mode),
      rays(camera.model, 0, 0, kNumLevels),
      textures(patterns_of(map)),
      scratch(std::make_unique<PhotometricScratch>()) {
  if (width > 0 && height > 0) fit_size(width, height);
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    const MapTag& tag = map.tags[i];
    tags.push_back({tag, i, textures.pattern(i).half_extent(),
                    camera_from_tag_plane(tag.T_map_tag, tag.size_m),
                    tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ()});
  }
}

PhotometricWorld::~PhotometricWorld() = default;
PhotometricWorld::PhotometricWorld(PhotometricWorld&&) noexcept = default;
PhotometricWorld& PhotometricWorld::operator=(PhotometricWorld&&) noexcept = default;

void PhotometricWorld::fit_size(int width, int height) {
  rays = PixelRays(model, width, height, kNumLevels);
  max_view_angle_rad = apriltrack::max_view_angle_rad(model, width, height);
}

}  // namespace apriltrack
