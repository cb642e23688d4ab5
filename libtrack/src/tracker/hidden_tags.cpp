#include "hidden_tags.h"

#include <algorithm>

namespace apriltrack {

void HiddenTags::mark(PhotometricWorld& world, const std::vector<TagObservation>& observations) const {
  for (PhotometricTag& tag : world.tags) {
    const bool is_read = std::ranges::any_of(
        observations, [&](const TagObservation& seen) { return seen.tag->key == tag.tag.key; });
    const auto found = frames_unseen_.find(static_cast<int>(tag.index));
    tag.is_hidden = !is_read && found != frames_unseen_.end() && found->second >= kMinFramesUnseen;
  }
}

void HiddenTags::learn(const std::vector<TagEvidence>& tags, const TagVotes& votes, bool is_sure) {
  for (const TagEvidence& tag : tags) {
    if (tag.is_explained() || std::ranges::count(votes.agreeing, tag.tag_index) > 0) {
      frames_unseen_.erase(tag.tag_index);
    } else if (is_sure) {
      ++frames_unseen_[tag.tag_index];
    }
  }
}

bool HiddenTags::is_empty() const {
  return std::ranges::none_of(frames_unseen_, [](const auto& tag) { return tag.second >= kMinFramesUnseen; });
}

}  // namespace apriltrack
