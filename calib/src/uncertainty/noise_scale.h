#pragma once

#include <vector>

#include "model/map_state.h"

namespace apriltrack {

/// How large the views' residuals are, robustly (half of them may be wrong) and less what each frame's pose
/// takes away: the numbers u and v of equation (5) apart, since what detectors, blur and lens models do to
/// corners differs in how much both ends of an edge share. The expected sizes count as a few residuals
/// beside those of the fit. Where detectors claim covariances, what corners err by beyond them is the
/// likeliest. `of_frame` and `of_view` are empty.
NoiseScale measure_noise(const Observations& observations, const std::vector<std::size_t>& views,
                         const MapState& state);

/// Degrees of freedom of Student's distribution, by which views err for which a detector makes claims: gloss,
/// shadows, what hides a part of a print. The likeliest of 8,000 views of 17 rendered worlds (bench/worlds):
/// errors of eight numbers, over their claims.
inline constexpr double kTailFreedom = 4.0;

/// How much noisier each view seems than its detector claims, by kTailFreedom; by TagView::index. 1 where the
/// detector claims nothing. Least squares that weigh views so, again and again, are the likeliest of
/// Student's distribution.
std::vector<double> measure_view_noise(const Observations& observations,
                                       const std::vector<std::size_t>& views, const MapState& state);

/// How much noisier than the others each frame is (blurred ones are), from views without outliers; 1 for all
/// where frames differ by no more than chance. Every frame is drawn towards the others, the more so the less
/// it says. (docs/algorithms/calibration.md, equation 6.)
std::vector<double> measure_frame_noise(const Observations& observations,
                                        const std::vector<std::size_t>& views, const MapState& state);

}  // namespace apriltrack
