#pragma once

#include <set>
#include <vector>

#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/photometric_world.h"
#include "blur_corners.h"

namespace apriltrack {

/// Tags of the map that were not seen where a sure pose puts them: behind a wall, a door, a person. Until
/// they are seen again they take no part: what stands before them says nothing of a state.
class HiddenTags {
 public:
  /// Before a frame: marks them in the world, but for those that the frame reads.
  void mark(PhotometricWorld& world, const std::vector<TagObservation>& observations) const;

  /// After a frame that is explained, by the evidence of all tags. Only a pose that rests on tags that were
  /// read, and has no rival, may tell that something is hidden.
  void learn(const std::vector<TagEvidence>& tags, const TagVotes& votes, bool has_rival);

 private:
  std::set<int> indices_;
};

}  // namespace apriltrack
