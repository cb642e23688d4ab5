#pragma once

#include <string>
#include <vector>

#include "part_solver.h"
#include "resting_frames.h"

namespace apriltrack {

// What a calibration says of what it found.

TagKey key_of(const Observations& observations, int tag);
std::vector<TagKey> keys_of(const Observations& observations, const std::vector<int>& tags);

/// Names the tags as left out, with the reason; nothing where there are none.
void leave_out(const Observations& observations, const std::vector<int>& tags, const std::string& reason,
               Findings& findings);

/// What to know of a part that was solved: faults of tags, what went, residuals.
void report_quality(const Observations& observations, const PartSolution& solution,
                    const CalibrationOptions& options, Findings& findings);

/// parts: all but the first are not in the map.
void report_other_parts(const Observations& observations, const std::vector<Part>& parts, Findings& findings);

/// moments_before: how many there were. A warning where most are at rest, and else talk.
void report_resting_frames(const RestingFrames& resting, std::size_t moments_before, Findings& findings,
                           const LogSink& log);

/// Where edge offsets are larger than expected: views of small tags, far off and from the front, may be
/// explained as well by edges that lie aside as by tags that lie nearer, and the scale follows.
void warn_of_edges(const std::vector<CameraCorrection>& corrections, const CalibrationOptions& options,
                   Findings& findings);

}  // namespace apriltrack
