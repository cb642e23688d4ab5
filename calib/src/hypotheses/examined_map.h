#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "hypotheses/tag_hypotheses.h"
#include "model/adjusted_part.h"

namespace apriltrack {

/// A map, and what may be wrong with it.
struct ExaminedMap {
  AdjustedPart solved;
  RobustMap robust;  ///< Of all that may be in the map.
  NullScale scale = {};
  /// Of each tag the likeliest, by the scale of most; the likeliest tag first. A faulty tag makes others seem
  /// to differ, too, so that how they do is for a map without it to tell.
  std::vector<TagHypothesis> faults = {};
  Contradictions contradictions = {};

  double worst_log_odds() const;  ///< -infinity of no tag.
  /// Frames that contradict the others, if that is more than chance: the map may be folded.
  std::size_t num_contradicting() const {
    return contradictions.are_there() || !contradictions.doubtful_tags.empty() ? contradictions.contradicting
                                                                               : 0;
  }
};

/// part: before outliers were removed. without: tags that are in `solved`, and not trusted. Null where the
/// views leave a pose undetermined.
std::unique_ptr<ExaminedMap> examine(const PartTask& task, const Part& part, AdjustedPart solved,
                                     const std::set<int>& without, const ParallelFor& parallel);

}  // namespace apriltrack
