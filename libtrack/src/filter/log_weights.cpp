#include "apriltrack/filter/log_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace apriltrack
