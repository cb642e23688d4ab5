#include "chance_readings.h"

#include <cmath>

#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

/// Of quads: a film of minutes shows ten thousands of them.
constexpr double kMostByChance = 1e-5;
/// Where the map's only tag is looked for, nothing else can confirm it: all of tag16h5 is refused but what
/// was read without a correction.
constexpr double kMostOfOneTag = 1e-4;

/// In how many ways `count` of `all` are chosen.
double choices(int all, int count) {
  double ways = 1.0;
  for (int i = 0; i < count; ++i) ways *= static_cast<double>(all - i) / static_cast<double>(i + 1);
  return ways;
}

}  // namespace

double chance_of_reading(const std::string& family, int num_mapped, int corrected_bits) {
  constexpr double kTurns = 4.0;
  const int num_bits = TagFamily::get(family).num_bits();
  return std::ldexp(kTurns * num_mapped * choices(num_bits, corrected_bits), -num_bits);
}

ReadingOdds::ReadingOdds(const TagMap& map) : is_of_one_tag_(map.tags.size() == 1) {
  for (const MapTag& tag : map.tags) ++num_mapped_[tag.key.family];
}

bool ReadingOdds::may_be_chance(const TagObservation& seen) const {
  const std::string& family = seen.tag->key.family;
  return chance_of_reading(family, num_mapped_.at(family), seen.corrected_bits) >=
         (is_of_one_tag_ ? kMostOfOneTag : kMostByChance);
}

void ChanceReadings::were_read(const std::vector<TagObservation>& observations) {
  now_.clear();
  for (const TagObservation& seen : observations) {
    if (!seen.is_repeated && !odds_.may_be_chance(seen)) now_.insert(seen.tag_index);
  }
  ever_.insert(now_.begin(), now_.end());
}

}  // namespace apriltrack
