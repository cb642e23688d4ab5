#pragma once

#include <string_view>
#include <vector>

namespace apriltrack {

/// Throws Error(kInvalidInput) that names the model, the index and the value of a coefficient that is not
/// finite.
void check_coefficients(const std::vector<double>& coefficients, std::string_view model);

}  // namespace apriltrack
