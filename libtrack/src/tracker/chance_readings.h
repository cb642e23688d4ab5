#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "apriltrack/photometric/photometric_world.h"
#include "tag_observation.h"

namespace apriltrack {

/// Of the map's tags of a family: how many of the quads that show none of them chance would read as one, with
/// so many bits corrected, were their bits thrown like coins.
double chance_of_reading(const std::string& family, int num_mapped, int corrected_bits);

/// Which tags were read so that chance is no explanation: of tag16h5 with its 16 bits, for one, few are; a
/// film without any shows some in every other frame.
class ChanceReadings {
 public:
  explicit ChanceReadings(const PhotometricWorld& world);

  void were_read(const std::vector<TagObservation>& observations);
  bool is_surely_read(int tag_index) const { return surely_read_.contains(tag_index); }

 private:
  std::map<std::string, int> num_mapped_;  ///< By family.
  std::set<int> surely_read_;
};

}  // namespace apriltrack
