#pragma once

#include <vector>

#include "explanation.h"

namespace apriltrack {

/// Tags in view of a first explanation that are not explained, where two or more others are: hidden ones, of
/// a map of many rooms, each a little like what is seen in its place, by chance; together they pull the pose
/// off, and vote for a velocity. Empty where the motion so far is known, which they pull little.
std::vector<TagEvidence> unexplained_at_start(const Explanation& best);

/// Whether the tags that `from` explains stay where they are, within 3 px.
bool is_same_place(const PhotometricWorld& world, const Explanation& from, const Explanation& to);

/// That tags are not seen speaks against a state that was found without them all the same.
void add_unexplained(const std::vector<TagEvidence>& tags, Explanation& explanation);

/// While it lives, these tags are not looked at.
class TagsPutAside {
 public:
  /// world: must outlive it. tags: none of them hidden.
  TagsPutAside(PhotometricWorld& world, const std::vector<TagEvidence>& tags);
  ~TagsPutAside();
  TagsPutAside(const TagsPutAside&) = delete;
  TagsPutAside& operator=(const TagsPutAside&) = delete;

 private:
  PhotometricWorld& world_;
  std::vector<int> tags_;
};

}  // namespace apriltrack
