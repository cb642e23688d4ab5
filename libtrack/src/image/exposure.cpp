#include "apriltrack/image/exposure.h"

#include <fmt/format.h>

namespace apriltrack {

std::optional<std::string> fault_of_exposure(double exposure_s) {
  if (exposure_s >= kMinExposure_s && exposure_s <= kMaxExposure_s) return std::nullopt;  // false for NaN
  return fmt::format("must lie in [{:g}, {:g}] seconds (is {:g})", kMinExposure_s, kMaxExposure_s,
                     exposure_s);
}

}  // namespace apriltrack
