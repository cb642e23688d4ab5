#pragma once

#include <set>

#include "part_adjustment.h"

namespace apriltrack {

/// Takes tags out of `solved` whose views leave them a second pose, about as likely
/// (AdjustedPart::undecided), and adjusts the others anew; where the held tag is one of them, another is
/// held. part: before outliers were removed. Throws Error(kNoResult) when the held tag was chosen by the
/// user, and when too little is left.
void leave_out_undecided(const PartTask& task, const Part& part, AdjustedPart& solved);

/// Holds another tag where the held one is among those that `go`; false where the user chose it, or there is
/// no other.
bool hold_another(const PartTask& task, const std::set<int>& go, AdjustedPart& solved);

/// The tags of `part` but those that are `gone`, adjusted anew, as far as they connect to the held one, which
/// must stay. False, and nothing done, where fewer than two are left.
bool adjust_without(const PartTask& task, const Part& part, const std::set<int>& gone, AdjustedPart& solved);

}  // namespace apriltrack
