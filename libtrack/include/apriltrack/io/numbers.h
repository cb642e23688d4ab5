#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace apriltrack {

/// The whole text as a number, in the C locale whatever the program's locale is; nullopt when it is none.
/// "inf" and "nan" are read: whoever wants finite numbers asks.
std::optional<double> parse_double(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

/// Shortest text that reads back as the same double.
std::string format_exact(double value);

/// value times 10^exponent, as exact as a double can be: the decimal point of format_exact(value) is moved,
/// so that 165.1 mm are 0.1651 m, and back. value: finite.
double shift_decimal(double value, int exponent);

}  // namespace apriltrack
