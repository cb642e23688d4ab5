#include "hidden_tags.h"

#include <algorithm>

namespace apriltrack {

void HiddenTags::mark(PhotometricWorld& world, const std::vector<TagObservation>& observations) {
  unmark(world);
  for (const int index : hidden_) world.tag_at(index).is_hidden = true;
  for (const TagObservation& seen : observations) world.tag_at(seen.tag_index).is_hidden = false;
  marked_.assign(hidden_.begin(), hidden_.end());
}

void HiddenTags::unmark(PhotometricWorld& world) {
  for (const int index : marked_) world.tag_at(index).is_hidden = false;
  marked_.clear();
}

void HiddenTags::learn(const std::vector<TagEvidence>& tags, const TagVotes& votes, bool is_sure) {
  for (const TagEvidence& tag : tags) {
    if (tag.is_explained() || std::ranges::count(votes.agreeing, tag.tag_index) > 0) {
      frames_unseen_.erase(tag.tag_index);
      hidden_.erase(tag.tag_index);
    } else if (is_sure && ++frames_unseen_[tag.tag_index] >= kMinFramesUnseen) {
      hidden_.insert(tag.tag_index);
    }
  }
}

}  // namespace apriltrack
