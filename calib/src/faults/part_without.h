#pragma once

#include <optional>
#include <set>

#include "apriltrack/base/parallel.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {

/// Tags that hang together, and the one that is held.
struct HeldPart {
  Part part;
  int held_tag = 0;
};

/// Whether the user asked for it (CalibrationOptions::held_tag).
bool is_held_by_wish(const PartTask& task, int tag);

/// What of `part` hangs together without the tags that are `gone`: with the tag that the user holds, if there
/// is one; else of several pieces the one with most tags, held by `held_tag` where that is among them.
/// nullopt where fewer than two tags are left, and where the user's would go.
std::optional<HeldPart> part_without(const PartTask& task, const Part& part, const std::set<int>& gone,
                                     int held_tag);

/// Adjusts that, from where `solved` is. part: before outliers were removed. False where too little is left,
/// or that does not settle: `solved` is as it was then.
bool adjust_without(const PartTask& task, const Part& part, const std::set<int>& gone, AdjustedPart& solved);

/// `tags`, and those of `known` that are not in the map.
std::set<int> tags_out(const AdjustedPart& solved, const std::set<int>& tags, const std::set<int>& known);

/// The map without some tags, from the start, for with them it may have been folded; by the cameras of
/// `solved`, which may have been refined. Without the tag that the user holds another one is held. False
/// where too little is left that agrees.
bool solve_without(const PartTask& task, const Part& part, const std::set<int>& gone, AdjustedPart& solved,
                   const ParallelFor& parallel);

}  // namespace apriltrack
