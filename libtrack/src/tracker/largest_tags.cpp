#include "largest_tags.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>

namespace apriltrack {

LargestTags::LargestTags(PhotometricWorld& world, std::span<const MotionState> states) : world_(world) {
  std::set<std::size_t> in_sight, largest;  // of any of the states
  for (const MotionState& state : states) {
    std::vector<std::size_t> seen = world.tags_in_sight(state);
    std::erase_if(seen, [&](std::size_t i) { return world.tags[i].is_hidden; });
    const Pose view = camera_from_map(state.pose, world.mode);
    std::ranges::stable_sort(seen, std::greater(), [&](std::size_t i) {
      const MapTag& tag = world.tags[i].tag;
      return tag.size_m / (view * tag.T_map_tag.translation()).norm();
    });
    in_sight.insert(seen.begin(), seen.end());
    seen.resize(std::min<std::size_t>(seen.size(), kMaxInSight));
    largest.insert(seen.begin(), seen.end());
  }
  std::ranges::set_difference(in_sight, largest, std::back_inserter(left_out_));
  for (const std::size_t i : left_out_) world.tags[i].is_hidden = true;
}

LargestTags::~LargestTags() {
  for (const std::size_t i : left_out_) world_.tags[i].is_hidden = false;
}

}  // namespace apriltrack
