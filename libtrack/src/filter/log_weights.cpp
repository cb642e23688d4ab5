#include "apriltrack/filter/log_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();

double largest(std::span<const double> values) {
  double result = kMinusInfinity;
  for (const double value : values) {
    if (value > result) result = value;
  }
  return result;
}

}  // namespace

double log_sum_exp(std::span<const double> values) {
  const double top = largest(values);
  if (!std::isfinite(top)) return top;
  double sum = 0.0;
  for (const double value : values) {
    if (!std::isnan(value)) sum += std::exp(value - top);
  }
  return top + std::log(sum);
}

std::vector<double> normalized_weights(std::span<const double> log_weights) {
  const double total = log_sum_exp(log_weights);
  std::vector<double> weights(log_weights.size(),
                              1.0 / static_cast<double>(std::max<std::size_t>(1, log_weights.size())));
  if (!std::isfinite(total)) return weights;
  std::transform(log_weights.begin(), log_weights.end(), weights.begin(),
                 [&](double value) { return std::isnan(value) ? 0.0 : std::exp(value - total); });
  return weights;
}

double effective_size(std::span<const double> weights) {
  double squares = 0.0;
  for (const double weight : weights) squares += weight * weight;
  return squares > 0.0 ? 1.0 / squares : 0.0;
}

double next_temperature(std::span<const double> log_likelihoods, double from, double effective_share) {
  APRILTRACK_CHECK(effective_share > 0.0 && effective_share < 1.0, "effective_share must lie in (0, 1)");
  const double wanted = effective_share * static_cast<double>(log_likelihoods.size());
  std::vector<double> scaled(log_likelihoods.size());
  const auto is_enough = [&](double beta) {
    std::transform(log_likelihoods.begin(), log_likelihoods.end(), scaled.begin(),
                   [&](double value) { return (beta - from) * value; });
    return effective_size(normalized_weights(scaled)) >= wanted;
  };
  if (is_enough(1.0)) return 1.0;
  double low = from, high = 1.0;
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (is_enough(middle) ? low : high) = middle;
  }
  return high;
}

}  // namespace apriltrack
