#include "exposure_check.h"

#include <fmt/format.h>

#include <utility>

#include "apriltrack/base/error.h"

namespace apriltrack::app {

void ExposureCheck::add(Timestamp time, const std::optional<double>& exposure_s) {
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
      "time between frames (camera file, or exposure_s in frames.csv)",
      *exposure_s, interval_s, time.ns);
  if (was_second) throw invalid_input("exposure_time", fault);
  if (!has_warned_) warnings_.add("exposure_time: " + fault);
  has_warned_ = true;
}

}  // namespace apriltrack::app
