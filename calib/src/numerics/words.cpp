#include "numerics/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace apriltrack {

std::string join_first(std::span<const std::string> items, std::string_view separator, std::size_t most) {
  const auto first = items.first(std::min(most, items.size()));
  std::string text = fmt::format("{}", fmt::join(first, separator));
  if (items.size() > most) text += fmt::format(" and {} more", items.size() - most);
  return text;
}

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string in_two_digits(double value) {
  constexpr double kNeedsMore = 99.5;  // rounds to three
  return std::abs(value) < kNeedsMore ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

}  // namespace apriltrack
