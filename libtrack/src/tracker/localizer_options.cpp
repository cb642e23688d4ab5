#include <fmt/format.h>

#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/tracker/localizer.h"

namespace apriltrack {

void LocalizerOptions::check() const {
  if (!(corner_sigma_px > 0.0 && std::isfinite(corner_sigma_px))) {
    throw invalid_input("corner_sigma_px", fmt::format("must be > 0 (is {})", corner_sigma_px));
  }
  if (!(max_residual_rms_px >= corner_sigma_px && std::isfinite(max_residual_rms_px))) {
    throw invalid_input("max_residual_rms_px", fmt::format("must be at least corner_sigma_px, {} (is {})",
                                                           corner_sigma_px, max_residual_rms_px));
  }
  detector.check();
}

}  // namespace apriltrack
