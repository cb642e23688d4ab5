#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apriltrack/eval/trajectory.h"

namespace apriltrack {

/// For each true frame the estimate's pose nearest in time, if it is near enough.
using Matches = std::vector<const TimedPose*>;

Matches match(const Trajectory& truth, const Trajectory& estimate);

std::ptrdiff_t count_matches(const Matches& matches);

/// Poses of the estimate to which no true frame is near enough.
int count_unmatched(const Trajectory& truth, const Trajectory& estimate);

/// How the times differ, for the user whose recordings do not meet.
std::string describe_time_mismatch(const Trajectory& truth, const Trajectory& estimate);

}  // namespace apriltrack
