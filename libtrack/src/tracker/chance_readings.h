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

/// Which tags are read so that chance is no explanation: of tag16h5 with its 16 bits, for one, few are; a
/// film without any shows some in every other frame.
class ChanceReadings {
 public:
  explicit ChanceReadings(const PhotometricWorld& world);

  /// In every frame, before the others are asked.
  void were_read(const std::vector<TagObservation>& observations);
  bool is_surely_read_now(int tag_index) const { return now_.contains(tag_index); }
  /// In this recording.
  bool was_surely_read(int tag_index) const { return ever_.contains(tag_index); }

 private:
  bool is_sure(const TagObservation& seen) const;

  std::map<std::string, int> num_mapped_;  ///< By family.
  bool is_of_one_tag_;
  std::set<int> now_, ever_;
};

}  // namespace apriltrack
