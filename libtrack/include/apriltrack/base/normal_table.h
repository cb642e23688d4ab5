#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace apriltrack {

/// Of the standard normal distribution.
struct NormalValue {
  double below = 0.0;    ///< Its integral up to a place.
  double density = 0.0;  ///< There.
};

/// By cubics between the places of a table: to 1e-10, and several times as fast as erfc() and exp().
class NormalTable {
 public:
  static const NormalTable& get();

  NormalValue at(double place) const {
    if (!(place > -kReach)) return {0.0, 0.0};
    if (!(place < kReach)) return {1.0, 0.0};
    const double steps = (place + kReach) * kStepsPerUnit;
    const int step = std::min(static_cast<int>(steps), kNumSteps - 1);  // just under the reach it rounds up
    const double t = steps - step;
    const NormalValue& left = values_[static_cast<std::size_t>(step)];
    const NormalValue& right = values_[static_cast<std::size_t>(step + 1)];
    constexpr double kPerStep = 1.0 / kStepsPerUnit;
    const double left_place = step * kPerStep - kReach;
    return {between(t, left.below, kPerStep * left.density, right.below, kPerStep * right.density),
            between(t, left.density, -kPerStep * left_place * left.density, right.density,
                    -kPerStep * (left_place + kPerStep) * right.density)};
  }

 private:
  NormalTable();

  /// Hermite's cubic at the share t of a step between two values and their slopes (per step).
  static double between(double t, double left, double left_slope, double right, double right_slope) {
    const double rise = right - left;
    const double a = left_slope - rise, b = rise - right_slope;
    return left + t * (rise + (1.0 - t) * (a * (1.0 - t) + b * t));
  }

  static constexpr double kReach = 7.0;  // beyond, 1e-12 is left
  static constexpr int kStepsPerUnit = 128;
  static constexpr int kNumSteps = static_cast<int>(2.0 * kReach) * kStepsPerUnit;
  std::array<NormalValue, kNumSteps + 1> values_;
};

}  // namespace apriltrack
