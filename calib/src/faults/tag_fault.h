#pragma once

#include <optional>
#include <vector>

#include "faults/tag_probe.h"
#include "model/tag_finding.h"

namespace apriltrack {

// Another shape is clear by so many standard deviations, and so much of the tag's size.
inline constexpr double kClearSigmas = 4.5, kClearScale = 0.012, kClearBend = 0.006;
// Of half the squares, by which one side alone must explain more than the size: e^3 times as likely.
inline constexpr double kLikelierSide = 3.0;

struct TagLook {
  /// What the views of one place with the stated shape cost, in units of what they would if they erred as
  /// expected; 0 where there are too few.
  double misfit = 0.0;
  /// None where nothing is clearly wrong, or nothing explains it.
  std::optional<TagFinding> finding;
};

/// Whether something explains the tag's views where one place and the stated shape do not: another size, a
/// bend, two places, one after the other or by turns, or no fixed place at all. probes: in the order of time.
/// solved: the map that foretells them.
TagLook look_at(const PartTask& task, const AdjustedPart& solved, const std::vector<ProbeView>& probes,
                int tag);

}  // namespace apriltrack
