#include "normal_distribution.h"

#include <cmath>
#include <numbers>

namespace apriltrack {

const NormalTable& NormalTable::get() {
  static const NormalTable table;
  return table;
}

NormalTable::NormalTable() {
  for (int i = 0; i <= kNumSteps; ++i) {
    const double place = static_cast<double>(i) / kStepsPerUnit - kReach;
    values_[static_cast<std::size_t>(i)] = {
        0.5 * std::erfc(-place / std::numbers::sqrt2),
        std::exp(-0.5 * place * place) / std::sqrt(2.0 * std::numbers::pi)};
  }
}

double student_place(double place, double degrees) {
  const double middle = degrees - 2.0 / 3.0 + 0.1 / degrees;
  return std::sqrt(degrees * std::expm1(place * place * (degrees - 5.0 / 6.0) / (middle * middle)));
}

}  // namespace apriltrack
