#include "apriltrack/photometric/photometric_world.h"

#include <fmt/format.h>

#include "apriltrack/base/error.h"

namespace apriltrack {

PhotometricWorld::PhotometricWorld(const Camera& camera, const TagMap& map, TrackMode track_mode, int width,
                                   int height)
    : model(camera.model), mode(track_mode), rays(camera.model, width, height, kNumLevels) {
  tags.reserve(map.tags.size());
  for (const MapTag& tag : map.tags) {
    const TagFamily& family = TagFamily::get(tag.key.family);
    if (tag.key.id < 0 || tag.key.id >= family.num_codes()) {
      throw invalid_input("map", fmt::format("tag {}: family {} has ids 0 to {}", tag.key.id, tag.key.family,
                                             family.num_codes() - 1));
    }
    tags.push_back({tag, PatternTextures(family.pattern(tag.key.id))});
  }
}

}  // namespace apriltrack
