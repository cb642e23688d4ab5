#pragma once

#include <optional>
#include <vector>

#include "apriltrack/calib/systematic_errors.h"
#include "hypotheses/print_aspect.h"
#include "hypotheses/print_batches.h"

namespace apriltrack {

/// How the views depend on errors of unit variance of prints that may not be as stated (size_errors,
/// aspect_errors); empty where there are none.
std::vector<ParameterView> errors_of_prints(const Observations& observations,
                                            const std::vector<std::size_t>& views, const MapState& state,
                                            const std::optional<PrintBatches>& batches,
                                            const std::optional<double>& aspect,
                                            CameraParameters refined_aspects);

}  // namespace apriltrack
