#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "apriltrack/base/version.h"

namespace apriltrack {

inline constexpr std::int64_t kNsPerSecond = 1'000'000'000;

/// A moment in int64 nanoseconds since the epoch of the recording's clock. A frame's time is the MIDDLE of
/// its exposure. Never held in a double: 1e18 ns in a double loses 128 ns.
struct Timestamp {
  std::int64_t ns = 0;

  auto operator<=>(const Timestamp&) const = default;
};

/// |a - b|, exact for any two times; a signed difference may not fit into 64 bits.
std::uint64_t nanoseconds_apart(Timestamp a, Timestamp b);
/// later - earlier, in seconds.
double seconds_between(Timestamp earlier, Timestamp later);
/// Rounded to the nearest nanosecond.
Timestamp advance(Timestamp time, double seconds);

/// Seconds with nine decimals, "12.034000000"; exact, never through a float.
std::string format_seconds(Timestamp time);
/// Reads what format_seconds writes, and any other number of decimals (digits beyond the ninth are cut).
std::optional<Timestamp> parse_seconds(std::string_view text);
/// Reads whole nanoseconds, as in a file name that is all digits.
std::optional<Timestamp> parse_nanoseconds(std::string_view text);

}  // namespace apriltrack
