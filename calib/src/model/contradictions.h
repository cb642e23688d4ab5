#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "observations/parts.h"

namespace apriltrack {

/// Of a coin of the first chance from one of the second (Kullback and Leibler); 0 where the first is less.
/// Times the throws: the logarithm of how unlikely such a share is, at least (Chernoff's bound).
double divergence(double share, double chance);

/// Where an adjusted part contradicts the frames it was made from, more than outliers that come by chance do.
struct Contradictions {
  std::size_t frames = 0;         ///< Frames of the part.
  std::size_t contradicting = 0;  ///< Those in which a view is far off.
  /// Accused in over a third of their frames: a tag that was moved, or of wrong size.
  std::vector<int> tags;
  /// Far off in over half of the frames that show both: the way from one to the other over further tags does
  /// not end where the pictures have it, as when an id hangs in two places.
  std::vector<std::pair<int, int>> links;

  /// Accused more often than by chance, in whatever share of their frames; the clearest first.
  std::vector<int> doubtful_tags = {};

  bool are_there() const { return !tags.empty() || !links.empty(); }
};

/// gross: those of part.views that are far off, sorted; the others count as fitting. A frame that shows two
/// fitting tags accuses the others; one that does not accuses all of its tags, for of two tags that
/// contradict each other the fit sacrifices either.
Contradictions find_contradictions(const Observations& observations, const Part& part,
                                   const std::vector<std::size_t>& gross);

}  // namespace apriltrack
