#include "hidden_tags.h"

#include <algorithm>

namespace apriltrack {
namespace {

/// Tags that were missed before a map is doubted: fewer may hang behind one wall.
constexpr std::size_t kMinMissed = 10;
/// Independent samples of a tag that is seen: fewer fit by chance.
constexpr double kMinSamplesOfSeen = 100.0;
/// A tag that is doubted is looked for in one of so many frames.
constexpr int kTurns = 8;

bool agrees(const TagVotes& votes, int tag) {
  return std::ranges::count(votes.agreeing, tag) > 0;
}

void reveal(PhotometricWorld& world, int tag) {
  world.tag_at(tag).is_hidden = world.tag_at(tag).is_passed_over = false;
}

}  // namespace

void HiddenTags::mark(PhotometricWorld& world, const std::vector<TagObservation>& observations) {
  mark_doubted(world, observations);
  for (const int tag : hidden_) hide(world, tag);
  for (int tag = 0; is_map_doubted_ && tag < static_cast<int>(world.tags.size()); ++tag) {
    if (!was_seen(tag)) hide(world, tag);
  }
  for (const TagObservation& seen : observations) reveal(world, seen.tag_index);
}

void HiddenTags::mark_doubted(PhotometricWorld& world, const std::vector<TagObservation>& observations) {
  unmark(world);
  if (!is_map_doubted_) return;
  for (const auto& [tag, frames] : frames_unseen_) {
    if (was_seen(tag)) continue;
    hide(world, tag);
    world.tag_at(tag).is_passed_over = (tag + turn_) % kTurns != 0;
  }
  for (const TagObservation& seen : observations) reveal(world, seen.tag_index);
}

void HiddenTags::hide(PhotometricWorld& world, int tag) {
  world.tag_at(tag).is_hidden = true;
  marked_.push_back(tag);
}

void HiddenTags::unmark(PhotometricWorld& world) {
  for (const int tag : marked_) reveal(world, tag);
  marked_.clear();
}

void HiddenTags::learn(const std::vector<TagEvidence>& tags, const TagVotes& votes, bool is_sure) {
  for (const TagEvidence& tag : tags) {
    const int index = tag.tag_index;
    const bool is_explained = tag.is_explained();
    if (agrees(votes, index) || (is_explained && tag.independent_samples() >= kMinSamplesOfSeen))
      note_seen(index);
    if (agrees(votes, index) || (is_explained && !is_doubted(index))) {
      frames_unseen_.erase(index);
      hidden_.erase(index);
    } else if (is_sure && ++frames_unseen_[index] >= kMinFramesUnseen) {
      hidden_.insert(index);
    }
  }
  doubt_map();
  ++turn_;
}

bool HiddenTags::has_hopeful() const {
  return is_map_doubted_ || !hidden_.empty();
}

bool HiddenTags::was_seen(int tag) const {
  const auto index = static_cast<std::size_t>(tag);
  return index < was_seen_.size() && was_seen_[index];
}

void HiddenTags::note_seen(int tag) {
  if (was_seen(tag)) return;
  const auto index = static_cast<std::size_t>(tag);
  was_seen_.resize(std::max(was_seen_.size(), index + 1));
  was_seen_[index] = true;
  ++num_seen_;
}

void HiddenTags::doubt_map() {
  const auto num_missed =
      static_cast<std::size_t>(std::ranges::count_if(hidden_, [&](int tag) { return !was_seen(tag); }));
  is_map_doubted_ = num_missed >= kMinMissed && num_missed > num_seen_;
}

}  // namespace apriltrack
