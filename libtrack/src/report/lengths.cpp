#include "apriltrack/report/lengths.h"

#include <fmt/format.h>

#include <cmath>

namespace apriltrack {
namespace {

std::string without_end_zeros(std::string number) {
  if (number.find('.') == std::string::npos) return number;
  number.erase(number.find_last_not_of('0') + 1);
  if (number.back() == '.') number.pop_back();
  return number == "-0" ? "0" : number;
}

}  // namespace

std::string length_in_words(double length_m) {
  if (std::abs(length_m) >= 1.0) return without_end_zeros(fmt::format("{:.3f}", length_m)) + " m";
  const double length_mm = 1e3 * length_m;
  if (std::abs(length_mm) < 1.0) return fmt::format("{:.3g} mm", length_mm == 0.0 ? 0.0 : length_mm);
  return without_end_zeros(fmt::format("{:.{}f}", length_mm, std::abs(length_mm) >= 100.0 ? 1 : 2)) + " mm";
}

LengthUnit unit_for(double longest_m) {
  return longest_m < 1.0 ? LengthUnit{"mm", 1e3} : LengthUnit{"m", 1.0};
}

}  // namespace apriltrack
