#include "apriltrack/base/timestamp.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace apriltrack {
namespace {

constexpr std::size_t kDecimals = 9;

std::optional<std::int64_t> parse_digits(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool starts_with_digit = !text.empty() && text.front() >= '0' && text.front() <= '9';
  if (error != std::errc() || end != text.data() + text.size() || !starts_with_digit) return std::nullopt;
  return value;
}

}  // namespace

std::uint64_t nanoseconds_apart(Timestamp a, Timestamp b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<std::uint64_t>(high.ns) - static_cast<std::uint64_t>(low.ns);
}

double seconds_between(Timestamp earlier, Timestamp later) {
  const double apart_s = static_cast<double>(nanoseconds_apart(earlier, later)) * 1e-9;
  return earlier <= later ? apart_s : -apart_s;
}

Timestamp advance(Timestamp time, double seconds) {
  return {time.ns + std::llround(seconds * 1e9)};
}

std::string format_seconds(Timestamp time) {
  const char* sign = time.ns < 0 ? "-" : "";
  // Unsigned, so that the most negative number has a magnitude too.
  const auto magnitude =
      time.ns < 0 ? ~static_cast<std::uint64_t>(time.ns) + 1 : static_cast<std::uint64_t>(time.ns);
  return fmt::format("{}{}.{:09d}", sign, magnitude / kNsPerSecond, magnitude % kNsPerSecond);
}

std::optional<Timestamp> parse_seconds(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  const auto whole = parse_digits(text.substr(0, point));
  if (!whole || *whole > (INT64_MAX / kNsPerSecond) - 1) return std::nullopt;
  std::int64_t fraction = 0;
  if (point < text.size()) {
    std::string decimals(text.substr(point + 1));
    if (decimals.empty() || decimals.find_first_not_of("0123456789") != std::string::npos)
      return std::nullopt;
    decimals.resize(kDecimals, '0');
    fraction = *parse_digits(decimals);
  }
  const std::int64_t ns = *whole * kNsPerSecond + fraction;
  return Timestamp{negative ? -ns : ns};
}

std::optional<Timestamp> parse_nanoseconds(std::string_view text) {
  const auto ns = parse_digits(text);
  if (!ns) return std::nullopt;
  return Timestamp{*ns};
}

}  // namespace apriltrack
