#include "hidden_tags.h"

#include <algorithm>

namespace apriltrack {

void HiddenTags::mark(PhotometricWorld& world, const std::vector<TagObservation>& observations) const {
  for (PhotometricTag& tag : world.tags) {
    const bool is_read = std::ranges::any_of(
        observations, [&](const TagObservation& seen) { return seen.tag->key == tag.tag.key; });
    tag.is_hidden = !is_read && indices_.contains(static_cast<int>(tag.index));
  }
}

void HiddenTags::learn(const std::vector<TagEvidence>& tags, const TagVotes& votes, bool has_rival) {
  for (const TagEvidence& tag : tags) {
    if (tag.is_explained() || std::ranges::count(votes.agreeing, tag.tag_index) > 0) {
      indices_.erase(tag.tag_index);
    } else if (!votes.agreeing.empty() && !has_rival) {
      indices_.insert(tag.tag_index);
    }
  }
}

}  // namespace apriltrack
