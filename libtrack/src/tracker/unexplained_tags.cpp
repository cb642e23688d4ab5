#include "unexplained_tags.h"

#include <algorithm>
#include <functional>
#include <iterator>

#include "place_spread.h"

namespace apriltrack {
namespace {

/// Of one alone that is explained, the tilt may be another's.
constexpr std::size_t kLeastExplained = 2;
/// Chance pulls by less; what moves further has found another place.
constexpr double kSamePlace_px = 3.0;

}  // namespace

std::vector<TagEvidence> unexplained_at_start(const Explanation& best) {
  std::vector<TagEvidence> unexplained;
  if (!best.is_cold || !best.is_explained()) return unexplained;
  std::ranges::copy_if(best.fit.tags, std::back_inserter(unexplained),
                       std::not_fn(&TagEvidence::is_explained));
  if (unexplained.size() + kLeastExplained > best.fit.tags.size()) unexplained.clear();
  return unexplained;
}

bool is_same_place(const PhotometricWorld& world, const Explanation& from, const Explanation& to) {
  return std::ranges::all_of(explained_tags(from.fit.tags), [&](const TagEvidence& tag) {
    return place_shift_px(world, world.tag_at(tag.tag_index), from.fit.state.pose, to.fit.state.pose) <
           kSamePlace_px;
  });
}

void add_unexplained(const std::vector<TagEvidence>& tags, Explanation& explanation) {
  for (const TagEvidence& tag : tags) {
    explanation.fit.tags.push_back(tag);
    explanation.fit.equations.push_back({.evidence = tag});
  }
}

TagsPutAside::TagsPutAside(PhotometricWorld& world, const std::vector<TagEvidence>& tags) : world_(world) {
  for (const TagEvidence& tag : tags) tags_.push_back(tag.tag_index);
  for (const int tag : tags_) world_.tag_at(tag).is_hidden = true;
}

TagsPutAside::~TagsPutAside() {
  for (const int tag : tags_) world_.tag_at(tag).is_hidden = false;
}

}  // namespace apriltrack
