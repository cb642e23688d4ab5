#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "apriltrack/tags/tag_map.h"
#include "tag_observation.h"

namespace apriltrack {

/// Of the map's tags of a family: how many of the quads that show none of them chance would read as one, with
/// so many bits corrected, were their bits thrown like coins.
double chance_of_reading(const std::string& family, int num_mapped, int corrected_bits);

/// Which readings of a map's tags chance may explain: of tag16h5 with its 16 bits, for one, most.
class ReadingOdds {
 public:
  explicit ReadingOdds(const TagMap& map);

  /// seen: of the map. Where the map's only tag is looked for, nothing else can confirm it, and more is
  /// believed. Does not ask whether the frame shows the tag twice.
  bool may_be_chance(const TagObservation& seen) const;

 private:
  std::map<std::string, int> num_mapped_;  ///< By family.
  bool is_of_one_tag_;
};

/// Which tags are read so that chance is no explanation; a film without tag16h5 shows some of these in every
/// other frame.
class ChanceReadings {
 public:
  explicit ChanceReadings(const TagMap& map) : odds_(map) {}

  /// In every frame, before the others are asked.
  void were_read(const std::vector<TagObservation>& observations);
  bool is_surely_read_now(int tag_index) const { return now_.contains(tag_index); }
  /// In this recording.
  bool was_surely_read(int tag_index) const { return ever_.contains(tag_index); }

 private:
  ReadingOdds odds_;
  std::set<int> now_, ever_;
};

}  // namespace apriltrack
