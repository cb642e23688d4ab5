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

/// The temperature beta in (from, 1] at which weights exp((beta - from) * log_likelihood) are worth
/// `effective_share` of the particles (Del Moral, Doucet, Jasra, "Sequential Monte Carlo samplers", 2006):
/// 1 when even that keeps more. Bisection to 1e-6. Requires effective_share in (0, 1).
double next_temperature(std::span<const double> log_likelihoods, double from, double effective_share);

}  // namespace apriltrack
