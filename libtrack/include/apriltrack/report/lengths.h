#pragma once

#include <string>

namespace apriltrack {

/// A length for people, on the terminal and on pages alike: metres from a metre on, to the millimetre;
/// millimetres below, to a hundredth; below one to three digits. "1.234 m", "162 mm", "1.48 mm", "0.00812
/// mm".
std::string length_in_words(double length_m);

/// What a chart's lengths are told in, by the longest of them.
struct LengthUnit {
  const char* name;
  double per_m;
};
LengthUnit unit_for(double longest_m);

}  // namespace apriltrack
