#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace apriltrack {

/// "a, b and 5 more": the first `most` of them.
std::string join_first(std::span<const std::string> items, std::string_view separator, std::size_t most);

/// "1 tag", "2 tags".
std::string counted(std::size_t count, std::string_view noun);

/// "0.021", "6.3", "120": in two digits, or as many as are before the point.
std::string in_two_digits(double value);

}  // namespace apriltrack
