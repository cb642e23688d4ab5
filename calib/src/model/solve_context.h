#pragma once

#include <string_view>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "model/view_candidates.h"
#include "observations/observations.h"

namespace apriltrack {

inline constexpr std::string_view kWhatToCheck =
    "check the tag family and the tag sizes, the camera file, that all pictures have its size, "
    "and that no tag was moved while filming";

/// Everything that the solving of a part needs besides the part.
struct PartTask {
  const Observations& observations;
  const std::vector<ViewCandidates>& candidates;
  const CalibrationOptions& options;
};

/// For what is one of several bodies that run side by side; asks whether to stop.
ParallelFor on_one_thread(const PartTask& task);

}  // namespace apriltrack
