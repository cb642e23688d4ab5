#include "apriltrack/eval/statistics.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> sorted(std::span<const double> values) {
  std::vector<double> copy(values.begin(), values.end());
  std::ranges::sort(copy);
  return copy;
}

}  // namespace

double mean(std::span<const double> values) {
  if (values.empty()) return kNan;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double root_mean_square(std::span<const double> values) {
  if (values.empty()) return kNan;
  const double sum = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double median(std::span<const double> values) {
  if (values.empty()) return kNan;
  const std::vector<double> s = sorted(values);
  const std::size_t half = s.size() / 2;
  return s.size() % 2 == 1 ? s[half] : (s[half - 1] + s[half]) / 2.0;
}

double percentile(std::span<const double> values, double fraction) {
  APRILTRACK_CHECK(fraction >= 0.0 && fraction <= 1.0, "a percentile is asked for by a fraction in [0, 1]");
  if (values.empty()) return kNan;
  const std::vector<double> s = sorted(values);
  const double rank = static_cast<double>(s.size() - 1) * fraction;
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, s.size() - 1);
  const double part = rank - static_cast<double>(below);
  const double step = s[above] - s[below];
  // From the nearer end, so that the last bit agrees with numpy where three printed decimals meet in a tie.
  return part >= 0.5 ? s[above] - step * (1.0 - part) : s[below] + step * part;
}

double round_to_decimals(double value, int decimals) {
  APRILTRACK_CHECK(decimals >= 0 && decimals <= 17, "decimals must be in [0, 17]");
  if (!std::isfinite(value)) return value;
  std::array<char, 400> text{};  // 309 digits before the point at most
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
  double rounded = 0.0;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

}  // namespace apriltrack
