#pragma once

#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "tag_fault.h"

namespace apriltrack {

inline constexpr const char* kTooLittleLeft = "what is left does not agree, or is too little";

/// Holds every tag of the part against the others, names what is wrong with it, and takes tags out of
/// `solved` that would be wrong in the map. part: before outliers were removed. Also of
/// those that were left out before. Throws Error(kNoResult) where the tag that the user holds would be taken
/// out.
std::vector<TagFinding> examine_tags(const PartTask& task, const Part& part, AdjustedPart& solved,
                                     const ParallelFor& parallel);

/// Throws Error(kNoResult): the tag that the user holds is at fault, as `words` say.
[[noreturn]] void fail_by_held_tag(const std::string& words);

/// Throws Error(kNoResult): after the findings had left tags out, the others gave no map.
[[noreturn]] void fail_after(const std::vector<TagFinding>& findings, const Error& error);

}  // namespace apriltrack
