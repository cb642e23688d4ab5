#pragma once

#include <map>
#include <vector>

#include "apriltrack/photometric/evidence.h"

namespace apriltrack {

/// How much lighter the white of each tag was than its black when it was seen last. What merely looks like a
/// blurred tag seldom has the contrast of print.
class ContrastMemory {
 public:
  void remember(const std::vector<TagEvidence>& tags);
  /// Takes the correlation of those whose contrast is not what it was: their evidence is none.
  void doubt(std::vector<TagEvidence>& tags) const;

 private:
  std::map<int, double> contrasts_;  ///< By index of the tag: no more than the map has.
};

}  // namespace apriltrack
