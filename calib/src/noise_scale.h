#pragma once

#include <vector>

#include "map_state.h"

namespace apriltrack {

/// How large the views' residuals are, robustly (half of them may be wrong) and less what each frame's pose
/// takes away: the numbers u and v of equation (5) apart, since what detectors, blur and lens models do to
/// corners differs in how much both ends of an edge share. The expected sizes count as a few residuals
/// beside those of the fit. `of_frame` is empty.
NoiseScale measure_noise(const Observations& observations, const std::vector<std::size_t>& views,
                         const MapState& state);

/// How much noisier than the others each frame is (blurred ones are), from views without outliers; 1 for all
/// where frames differ by no more than chance. Every frame is drawn towards the others, the more so the less
/// it says. (docs/algorithms/calibration.md, equation 6.)
std::vector<double> measure_frame_noise(const Observations& observations,
                                        const std::vector<std::size_t>& views, const MapState& state);

}  // namespace apriltrack
