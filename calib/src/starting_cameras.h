#pragma once

#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/base/parallel.h"
#include "observations.h"

namespace apriltrack {

/// The cameras to start from: the file's, or, of those by whose lens tags do not look square, with one by
/// which they do. Where the cameras must stay (Intrinsics::kKeep, or more tags than can be refined with
/// them), the file's, and a warning. observations.cameras: the file's, of which those that start with another
/// lens are of its distortion model, too.
std::vector<RigCamera> starting_cameras(Observations& observations, const CalibrationOptions& options,
                                        const ParallelFor& parallel, const LogSink& log, Findings& findings);

}  // namespace apriltrack
