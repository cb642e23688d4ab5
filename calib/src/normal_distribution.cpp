#include "normal_distribution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace apriltrack {
namespace {

constexpr double kTableReach = 7.0;  // beyond, 1e-12 is left
constexpr int kStepsPerUnit = 128;
constexpr int kNumSteps = static_cast<int>(2.0 * kTableReach) * kStepsPerUnit;

using Table = std::array<NormalValue, kNumSteps + 1>;

Table make_table() {
  Table table;
  for (int i = 0; i <= kNumSteps; ++i) {
    const double place = static_cast<double>(i) / kStepsPerUnit - kTableReach;
    table[static_cast<std::size_t>(i)] = {0.5 * std::erfc(-place / std::numbers::sqrt2),
                                          std::exp(-0.5 * place * place) / std::sqrt(2.0 * std::numbers::pi)};
  }
  return table;
}

/// Hermite's cubic at the share t of a step between two values and their slopes (per step).
double between(double t, double left, double left_slope, double right, double right_slope) {
  const double rise = right - left;
  const double a = left_slope - rise, b = rise - right_slope;
  return left + t * (rise + (1.0 - t) * (a * (1.0 - t) + b * t));
}

}  // namespace

NormalValue normal_at(double place) {
  static const Table table = make_table();
  if (!(place > -kTableReach)) return {0.0, 0.0};
  if (!(place < kTableReach)) return {1.0, 0.0};
  const double steps = (place + kTableReach) * kStepsPerUnit;
  const int step = std::min(static_cast<int>(steps), kNumSteps - 1);  // just under 7 the sum rounds up
  const double t = steps - step;
  const NormalValue& left = table[static_cast<std::size_t>(step)];
  const NormalValue& right = table[static_cast<std::size_t>(step + 1)];
  constexpr double kPerStep = 1.0 / kStepsPerUnit;
  const double left_place = step * kPerStep - kTableReach;
  return {between(t, left.below, kPerStep * left.density, right.below, kPerStep * right.density),
          between(t, left.density, -kPerStep * left_place * left.density, right.density,
                  -kPerStep * (left_place + kPerStep) * right.density)};
}

double student_place(double place, double degrees) {
  const double middle = degrees - 2.0 / 3.0 + 0.1 / degrees;
  return std::sqrt(degrees * std::expm1(place * place * (degrees - 5.0 / 6.0) / (middle * middle)));
}

}  // namespace apriltrack
