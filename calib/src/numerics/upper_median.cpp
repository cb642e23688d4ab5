#include "numerics/upper_median.h"

#include <algorithm>
#include <cstddef>

namespace apriltrack {

double upper_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace apriltrack
