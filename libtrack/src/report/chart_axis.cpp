#include "chart_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace apriltrack {
namespace {

constexpr double kTiny = 1e-9;          // of a step: what a round number may miss its place by
constexpr double kFarthest = 1e3;       // axis lengths; farther values are taken to lie there
constexpr double kIndistinct = 1e-12;   // of the value: numbers so close are taken for one
constexpr double kMaxMinorDecades = 8;  // more would make the minor grid a grey area

/// The largest (smallest when !downwards) of 1, 2, 5 x 10^n that is at most (at least) value > 0.
double round_number(double value, bool downwards) {
  const double decade = std::pow(10.0, std::floor(std::log10(value) + kTiny));
  double best = decade;
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    if (!downwards && factor * decade >= value * (1.0 - kTiny)) return factor * decade;
    if (downwards && factor * decade <= value * (1.0 + kTiny)) best = factor * decade;
  }
  return best;
}

struct Extent {
  double min = std::numeric_limits<double>::infinity();
  double max = -min;
  bool is_empty() const { return min > max; }
};

Extent extent_of(const std::vector<double>& values, bool is_logarithmic) {
  Extent extent;
  for (const double value : values) {
    if (!(std::abs(value) <= kLargestNumber) || (is_logarithmic && value <= 0.0)) continue;
    extent.min = std::min(extent.min, value);
    extent.max = std::max(extent.max, value);
  }
  return extent;
}

AxisRange linear_range(Extent extent) {
  if (extent.is_empty()) return {0.0, 1.0, false};
  const double largest = std::max(std::abs(extent.min), std::abs(extent.max));
  if (extent.max - extent.min <= kIndistinct * largest) {
    const double half = extent.min == 0.0 ? 1.0 : 0.5 * std::abs(extent.min);
    return {extent.min - half, extent.max + half, false};
  }
  constexpr double kAir = 0.03;
  constexpr double kNear = 0.2;  // of the largest value: from there on 0 is shown too
  const double air = kAir * (extent.max - extent.min);
  const bool starts_at_zero = extent.min >= 0.0 && extent.min <= kNear * extent.max;
  const bool ends_at_zero = extent.max <= 0.0 && extent.max >= kNear * extent.min;
  return {starts_at_zero ? 0.0 : extent.min - air, ends_at_zero ? 0.0 : extent.max + air, false};
}

AxisRange logarithmic_range(Extent extent) {
  if (extent.is_empty()) return {1.0, 10.0, true};
  const double low = round_number(extent.min, true);
  const double high = round_number(extent.max, false);
  return low < high ? AxisRange{low, high, true} : AxisRange{low / 2.0, high * 2.0, true};
}

std::string without_padding(std::string label) {
  const auto exponent = label.find('e');
  if (exponent == std::string::npos) return label;
  std::size_t digits = exponent + 1;
  if (label[digits] == '+') label.erase(digits, 1);
  if (label[digits] == '-') ++digits;
  while (digits + 1 < label.size() && label[digits] == '0') label.erase(digits, 1);
  return label;
}

/// All labels of an axis with as many digits as tell its ticks apart.
std::string label_of(double value, double step, double largest) {
  if (std::abs(value) < kTiny * step) return "0";
  const int step_digit = static_cast<int>(std::floor(std::log10(step) + kTiny));
  const int decimals = std::max(0, -step_digit);
  if (decimals <= 4 && (decimals > 0 || largest < 1e6)) return fmt::format("{:.{}f}", value, decimals);
  const int digits = static_cast<int>(std::floor(std::log10(largest) + kTiny)) - step_digit + 1;
  return without_padding(fmt::format("{:.{}g}", value, std::clamp(digits, 1, 17)));
}

/// Which multiples of the step lie in the range.
std::pair<double, double> multiples(const AxisRange& range, double step) {
  return {std::ceil(range.low / step - kTiny), std::floor(range.high / step + kTiny)};
}

std::vector<Tick> linear_ticks(const AxisRange& range, int max_labels) {
  double step = round_number((range.high - range.low) / (max_labels + 1), false);
  auto [first, last] = multiples(range, step);
  while (last - first + 1.0 > max_labels) {
    step = round_number(1.5 * step, false);
    std::tie(first, last) = multiples(range, step);
  }
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  std::vector<Tick> ticks;
  for (int i = 0; i <= last - first; ++i) {
    const double value = (first + i) * step;
    ticks.push_back({value, label_of(value, step, largest)});
  }
  return ticks;
}

bool holds(const AxisRange& range, double value) {
  return value >= range.low * (1.0 - kTiny) && value <= range.high * (1.0 + kTiny);
}

/// Every labelled_every-th decade has a label, and so have 2 and 5 times it if asked for.
std::vector<Tick> decade_ticks(const AxisRange& range, int labelled_every, bool labels_2_and_5,
                               bool has_minor) {
  std::vector<Tick> ticks;
  const int first = static_cast<int>(std::floor(std::log10(range.low) + kTiny));
  const int last = static_cast<int>(std::floor(std::log10(range.high) + kTiny));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int factor = 1; factor <= 9; ++factor) {
      const double value = std::pow(10.0, exponent) * factor;
      const bool has_label =
          factor == 1 ? exponent % labelled_every == 0 : labels_2_and_5 && (factor == 2 || factor == 5);
      if (!holds(range, value) || !(has_label || has_minor)) continue;
      ticks.push_back({value, has_label ? without_padding(fmt::format("{:g}", value)) : ""});
    }
  }
  return ticks;
}

int count_labels(const std::vector<Tick>& ticks) {
  return static_cast<int>(
      std::count_if(ticks.begin(), ticks.end(), [](const Tick& tick) { return !tick.label.empty(); }));
}

std::vector<Tick> logarithmic_ticks(const AxisRange& range, int max_labels) {
  constexpr int kEnough = 3;
  const double decades = std::log10(range.high / range.low);
  const bool has_minor = decades <= kMaxMinorDecades;
  auto ticks = decade_ticks(range, 1, true, has_minor);
  if (has_minor && count_labels(ticks) < kEnough) return linear_ticks(range, max_labels);
  if (decades <= 2.0 && count_labels(ticks) <= max_labels) return ticks;
  for (int every = 1;; ++every) {
    ticks = decade_ticks(range, every, false, has_minor);
    if (count_labels(ticks) <= std::max(1, max_labels)) return ticks;
  }
}

}  // namespace

double AxisRange::fraction(double value) const {
  double part = 0.0;
  if (!is_logarithmic) {
    part = (value - low) / (high - low);
  } else if (value > 0.0) {
    part = std::log(value / low) / std::log(high / low);
  }
  return std::clamp(part, -kFarthest, kFarthest);
}

AxisRange range_for(const ChartAxis& axis, const std::vector<double>& values) {
  const Extent extent = extent_of(values, axis.is_logarithmic);
  AxisRange range = axis.is_logarithmic ? logarithmic_range(extent) : linear_range(extent);
  if (axis.low) range.low = *axis.low;
  if (axis.high) range.high = *axis.high;
  if (range.low < range.high) return range;
  // All values lie beyond the end that is fixed.
  const double length = std::max(1.0, std::abs(axis.low ? range.low : range.high));
  if (axis.low) {
    range.high = axis.is_logarithmic ? 10.0 * range.low : range.low + length;
  } else {
    range.low = axis.is_logarithmic ? 0.1 * range.high : range.high - length;
  }
  return range;
}

std::vector<Tick> ticks_for(const AxisRange& range, int max_labels) {
  return range.is_logarithmic ? logarithmic_ticks(range, max_labels) : linear_ticks(range, max_labels);
}

}  // namespace apriltrack
