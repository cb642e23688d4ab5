#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/calib/calibration_options.h"
#include "observations/observations.h"

namespace apriltrack {

/// A camera file's lens by which tags do not look square.
struct LensDoubt {
  enum class Why { kReplaced, kKeptByOption, kKeptForManyTags };
  int camera = 0;  ///< Into Observations::cameras.
  Why why = Why::kReplaced;
};

/// The cameras to start from: the file's, or, of those by whose lens tags do not look square, with one by
/// which they do. Where the cameras must stay (Intrinsics::kKeep, or more tags than can be refined with
/// them), the file's. doubts: of both. observations.cameras: the file's, of which those that start with
/// another lens are of its distortion model, too.
std::vector<RigCamera> starting_cameras(Observations& observations, const CalibrationOptions& options,
                                        const ParallelFor& parallel, std::vector<LensDoubt>& doubts);

}  // namespace apriltrack
