#pragma once

#include <Eigen/Geometry>
#include <map>
#include <vector>

#include "apriltrack/photometric/evidence.h"

namespace apriltrack {

/// How much lighter the white of each tag was than its black when it was seen last. What merely looks like a
/// blurred tag seldom has the contrast of print.
class ContrastMemory {
 public:
  /// R_light_map: how the map is turned to what lights it; what turns to the light gets brighter.
  void remember(const std::vector<TagEvidence>& tags,
                const Eigen::Quaterniond& R_light_map = Eigen::Quaterniond::Identity());
  /// Takes the correlation of those whose contrast is not what it was: their evidence is none.
  void doubt(std::vector<TagEvidence>& tags,
             const Eigen::Quaterniond& R_light_map = Eigen::Quaterniond::Identity()) const;

 private:
  struct Seen {
    double contrast;
    Eigen::Quaterniond R_light_map;
  };
  std::map<int, Seen> seen_;  ///< By index of the tag: no more than the map has.
};

}  // namespace apriltrack
