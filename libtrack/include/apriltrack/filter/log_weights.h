#pragma once

#include <span>
#include <vector>

namespace apriltrack {

/// log(sum(exp(values))) without overflow; -infinity when empty or all are -infinity.
double log_sum_exp(std::span<const double> values);

/// Weights that sum to 1. Where every log weight is -infinity, nothing is known: all weights are equal.
/// NaN counts as -infinity.
std::vector<double> normalized_weights(std::span<const double> log_weights);

/// 1 / sum(w^2) of normalised weights: how many equal particles they are worth (Kong, Liu, Wong, 1994).
double effective_size(std::span<const double> weights);

}  // namespace apriltrack
