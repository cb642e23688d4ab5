#pragma once

#include <vector>

namespace apriltrack {

/// The middle one of the values, sorted; the upper of the middle two where their number is even. Not empty.
double upper_median(std::vector<double> values);

}  // namespace apriltrack
