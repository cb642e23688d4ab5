#include "option_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack::app {
namespace {

/// range: what the text must be.
template <class Accepts>
CLI::Validator must_be(const std::string& range, const Accepts& accepts) {
  const auto check = [range, accepts](std::string& text) {
    return accepts(text) ? std::string() : fmt::format("must be {} (is '{}')", range, text);
  };
  return CLI::Validator(check, "");
}

bool is_unsigned_64(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && error == std::errc() && end == text.data() + text.size();
}

CLI::Validator number(const std::string& range, double low, double high) {
  return must_be(range, [low, high](const std::string& text) {
    const auto value = parse_double(text);
    return value && *value >= low && *value <= high;  // false for NaN
  });
}

}  // namespace

CLI::Validator whole_number(long long low, std::optional<long long> high) {
  const std::string range = high ? fmt::format("a whole number from {} to {}", low, *high)
                                 : fmt::format("a whole number of at least {}", low);
  return must_be(range, [low, high](const std::string& text) {
    const auto value = parse_integer(text);
    return value && *value >= low && (!high || *value <= *high);
  });
}

CLI::Validator number_between(double low, double high) {
  return number(fmt::format("in [{:g}, {:g}]", low, high), low, high);
}

CLI::Validator number_at_least(double low) {
  return number(fmt::format("at least {:g}", low), low, std::numeric_limits<double>::infinity());
}

CLI::Validator not_empty(const std::string& what) {
  return CLI::Validator(
      [what](std::string& text) { return text.empty() ? "must not be empty: " + what : std::string(); }, "");
}

CLI::Validator no_option_of(const CLI::App& command) {
  return CLI::Validator(
      [&command](std::string& text) {
        const bool is_option = text.starts_with("--") && command.get_option_no_throw(text) != nullptr;
        return is_option ? fmt::format("has no value: {} follows, which is an option", text) : std::string();
      },
      "");
}

CLI::Validator seed() {
  // CLI11 alone would wrap -1 round, and make the largest number of what is larger than that.
  return must_be(fmt::format("a whole number from 0 to {}", std::numeric_limits<std::uint64_t>::max()),
                 is_unsigned_64);
}

CLI::Validator threads() {
  return whole_number(0, 256);
}

CLI::Validator rate() {
  return number("in [0.001, 1000000] frames a second", 1e-3, 1e6);
}

CLI::Validator decimation() {
  return must_be("1, 1.5, or a whole number from 2 to 8", [](const std::string& text) {
    const auto value = parse_double(text);
    return value && (*value == 1.5 || (*value >= 1.0 && *value <= 8.0 && *value == std::floor(*value)));
  });
}

CLI::Validator decision_margin() {
  return number_between(0.0, 255.0);
}

CLI::Validator corrected_bits() {
  return whole_number(0, 2);
}

CLI::Validator known_family() {
  return must_be(fmt::format("one of {}", fmt::join(TagFamily::names(), ", ")),
                 [](const std::string& text) { return TagFamily::is_known(text); });
}

void add_bits_option(CLI::App& command, std::optional<int>& bits) {
  command
      .add_option("--bits", bits,
                  "Of 16-bit image files: how many bits count, 8 to 16; white is then 2^BITS - 1. By default "
                  "as the pictures use them")
      ->check(whole_number(8, 16));
}

void check_families(const std::vector<std::string>& families) {
  for (const std::string& name : families) {
    if (std::count(families.begin(), families.end(), name) > 1)
      throw invalid_input("--family", fmt::format("'{}' is given more than once", name));
  }
}

void refuse_beside_detections(const CLI::App& command, std::initializer_list<const char*> options) {
  for (const char* name : options) {
    if (command.get_option(name)->count() == 0) continue;
    throw invalid_input(name,
                        "is for images and would change nothing with --detections, which has all corners and "
                        "times: leave it out");
  }
}

}  // namespace apriltrack::app
