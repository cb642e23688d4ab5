#include "largest_tags.h"

#include <algorithm>
#include <functional>

namespace apriltrack {

LargestTags::LargestTags(PhotometricWorld& world, std::span<const MotionState> states) : world_(world) {
  for (const MotionState& state : states) {
    std::vector<std::size_t> seen = world.tags_in_sight(state);
    std::erase_if(seen, [&](std::size_t i) { return world.tags[i].is_hidden; });
    if (seen.size() <= kMaxInSight) continue;
    const Pose view = camera_from_map(state.pose, world.mode);
    std::ranges::stable_sort(seen, std::greater(), [&](std::size_t i) {
      const MapTag& tag = world.tags[i].tag;
      return tag.size_m / (view * tag.T_map_tag.translation()).norm();
    });
    for (std::size_t k = kMaxInSight; k < seen.size(); ++k) {
      world.tags[seen[k]].is_hidden = true;
      left_out_.push_back(seen[k]);
    }
  }
}

LargestTags::~LargestTags() {
  for (const std::size_t i : left_out_) world_.tags[i].is_hidden = false;
}

}  // namespace apriltrack
