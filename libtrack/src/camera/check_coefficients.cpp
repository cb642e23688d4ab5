#include "check_coefficients.h"

#include <fmt/format.h>

#include <cmath>

#include "apriltrack/base/error.h"

namespace apriltrack {

void check_coefficients(const std::vector<double>& coefficients, std::string_view model) {
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    if (std::isfinite(coefficients[i])) continue;
    throw invalid_input(model, fmt::format("coefficients[{}] must be finite (is {})", i, coefficients[i]));
  }
}

}  // namespace apriltrack
