#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/photometric_world.h"
#include "blur_corners.h"

namespace apriltrack {

/// Tags of the map that sure poses put where they are not seen: behind a wall, a door, a person. Until they
/// are seen again they take no part: what stands before them says nothing of a state.
///
/// Where more tags were missed, and never seen, than were seen, the map is doubted, and all its tags that
/// were never seen with it: these take no part from the start, and once missed are looked for in turns. So
/// the time that a frame takes goes by the tags that are there.
class HiddenTags {
 public:
  /// So many sure poses must miss a tag: the first may be off, and every one is a fit of its own that the
  /// tag takes part in.
  static constexpr int kMinFramesUnseen = 3;

  /// Before a frame: marks them in the world, but for those that the frame reads.
  void mark(PhotometricWorld& world, const std::vector<TagObservation>& observations);
  /// Marks those alone that nothing is to be expected of, even where nothing else convinces: of a doubted
  /// map, those that were missed and never seen.
  void mark_doubted(PhotometricWorld& world, const std::vector<TagObservation>& observations);
  /// Takes the marks off.
  void unmark(PhotometricWorld& world);

  /// After a frame that is explained, by the evidence of all tags. is_sure: the pose was expected, rests on
  /// tags that were read and has no rival: only then does it tell that something is hidden.
  void learn(const std::vector<TagEvidence>& tags, const TagVotes& votes, bool is_sure);

  bool is_empty() const { return hidden_.empty(); }
  /// Whether mark_doubted() may leave any out that mark() marks.
  bool has_hopeful() const;

 private:
  bool was_seen(int tag) const;
  bool is_doubted(int tag) const { return is_map_doubted_ && !was_seen(tag); }
  void note_seen(int tag);
  void doubt_map();
  void hide(PhotometricWorld& world, int tag);

  std::map<int, int> frames_unseen_;  ///< By index of the tag, since it was seen last.
  std::set<int> hidden_;              ///< Those of them that enough frames missed.
  std::vector<int> marked_;           ///< In the world.
  std::vector<bool> was_seen_;        ///< By index of the tag.
  std::size_t num_seen_ = 0;
  bool is_map_doubted_ = false;
  int turn_ = 0;  ///< Of those that are looked for.
};

}  // namespace apriltrack
