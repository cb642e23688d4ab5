#include "apriltrack/io/numbers.h"

#include <fmt/format.h>

#include <charconv>

namespace apriltrack {
namespace {

template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> parse_double(std::string_view text) {
  return parse_whole<double>(text);
}

std::optional<long long> parse_integer(std::string_view text) {
  return parse_whole<long long>(text);
}

std::string format_exact(double value) {
  return fmt::format("{}", value);
}

double shift_decimal(double value, int exponent) {
  const std::string text = format_exact(value);
  const std::size_t e = text.find('e');
  const long long own = e == std::string::npos ? 0 : parse_integer(text.substr(e + 1)).value_or(0);
  return parse_double(fmt::format("{}e{}", text.substr(0, e), own + exponent)).value_or(value);
}

}  // namespace apriltrack
