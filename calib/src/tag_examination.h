#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tag_probe.h"

namespace apriltrack {

/// What is wrong with a tag, told in words that a user can act on.
struct TagFinding {
  enum class Kind { kSize, kMoved, kTwoPlaces, kNotFlat, kLoose };
  int tag = 0;
  Kind kind = Kind::kSize;
  std::string words;
  bool is_left_out = false;
  /// What the views cost, in units of what they would if they erred as expected: with one place and the
  /// stated shape, and with what was found.
  double misfit_before = 0.0, misfit_after = 0.0;

  /// Nothing is left to be explained.
  bool is_complete() const { return misfit_after < 1.6; }
  double gain() const { return misfit_before - misfit_after; }
};

/// What explains the tag's views, where one place and the stated shape do not: another size, a bend, two
/// places, one after the other or by turns, or no fixed place at all. nullopt where nothing is clearly wrong,
/// or nothing explains it. probes: in the order of time.
std::optional<TagFinding> diagnose(const std::vector<ProbeView>& probes, const Observations& observations,
                                   int tag);

/// What the views of one place with the stated shape cost, in units of what they would if they erred as
/// expected; 0 where there are too few.
double misfit_of(const std::vector<ProbeView>& probes, const Observations& observations, int tag);

/// Holds every tag of the part against the others, names what is wrong with it, and takes tags out of
/// `solved` that would be wrong in the map. part: before outliers were removed. Also of the culprit that was
/// left out before, if there is one.
std::vector<TagFinding> examine_tags(const PartTask& task, const Part& part, AdjustedPart& solved);

}  // namespace apriltrack
