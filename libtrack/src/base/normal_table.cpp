#include "apriltrack/base/normal_table.h"

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

}  // namespace apriltrack
