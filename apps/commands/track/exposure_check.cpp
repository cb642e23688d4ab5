#include "exposure_check.h"

#include <fmt/format.h>

#include <utility>

#include "apriltrack/base/error.h"

namespace apriltrack::app {

void ExposureCheck::add(Timestamp time, const std::optional<double>& exposure_s, std::string_view where) {
  constexpr double kRounding_s = 1e-3;  // video containers round times to a millisecond
  if (!previous_) {
    previous_ = time;
    return;
  }
  const double interval_s = seconds_between(*previous_, time);
  previous_ = time;
  const bool was_second = std::exchange(is_second_, false);
  if (!exposure_s || interval_s <= 0.0 || *exposure_s <= interval_s + kRounding_s) return;
  const std::string fault = fmt::format(
      "{} s is longer than the {:.6f} s since the frame before (at {} ns); it is in seconds, at most the "
      "time between frames",
      *exposure_s, interval_s, time.ns);
  if (was_second) throw invalid_input(where, fault);
  if (!has_warned_) console_.warning(fmt::format("{}: {}", where, fault));
  has_warned_ = true;
}

}  // namespace apriltrack::app
