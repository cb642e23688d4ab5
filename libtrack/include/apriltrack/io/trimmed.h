#pragma once

#include <string_view>

namespace apriltrack {

/// What separates words within a line.
inline constexpr std::string_view kBlanks = " \t\r";

/// The text without blanks, tabs and carriage returns at its ends.
std::string_view trimmed(std::string_view text);

}  // namespace apriltrack
