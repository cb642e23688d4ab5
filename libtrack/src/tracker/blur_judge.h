#pragma once

#include <optional>
#include <vector>

#include "contrast_memory.h"
#include "explanation.h"

namespace apriltrack {

/// Decides which explanation of a frame may be claimed (docs/algorithms/blur_tracker.md, section 6).
class BlurJudge {
 public:
  /// Enough of what should be seen is seen, and more tags speak for the state than against it: in the map of
  /// another place single tags fit, and only the others can tell. interval_s: since the last claim, if
  /// recent.
  bool is_convincing(const Explanation& explanation, const std::optional<double>& interval_s) const;
  /// Tags that speak for it: read and agreeing, or explained.
  int num_supporting(const Explanation& explanation) const;

  /// After a frame that was claimed.
  void claimed(const Explanation& explanation);
  /// After a frame without evidence. What is known of the tags stays: a detection renews it.
  void missed() { is_confirmed_ = false; }
  /// Whether every frame gave evidence since one with a detection that agrees.
  bool is_confirmed() const { return is_confirmed_; }

 private:
  /// Without a detection that agrees, tags of another contrast than they had count as not explained: in the
  /// image, and for the light that the sensor gathered. A step of the exposure changes the one, a step that
  /// an unknown gain makes up for the other.
  std::vector<TagEvidence> trusted_tags(const Explanation& explanation) const;

  ContrastMemory contrasts_;
  ContrastMemory radiances_;
  bool is_confirmed_ = false;  ///< Evidence in every frame since one with a detection that agrees.
};

}  // namespace apriltrack
