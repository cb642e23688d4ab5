#include <fmt/format.h>

#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/tracker/blur_tracker.h"

namespace apriltrack {

void BlurTrackerOptions::check() const {
  if (!(corner_sigma_px > 0.0 && std::isfinite(corner_sigma_px)))
    throw invalid_input("corner_sigma_px", fmt::format("must be > 0 (is {})", corner_sigma_px));
  if (num_particles < 16 || num_particles > 1'000'000)
    throw invalid_input("num_particles", fmt::format("must be 16 to 1000000 (is {})", num_particles));
  for (const double density : {motion_noise.linear_m2_per_s3, motion_noise.angular_rad2_per_s3}) {
    if (!(density > 0.0 && std::isfinite(density)))
      throw invalid_input("motion_noise", fmt::format("must be > 0 (is {})", density));
  }
  if (!(max_prediction_s >= 0.0 && max_prediction_s <= 0.5))
    throw invalid_input("max_prediction_s", fmt::format("must be 0 to 0.5 (is {})", max_prediction_s));
  if (!(default_exposure_s >= 0.0 && default_exposure_s <= 1.0))
    throw invalid_input("default_exposure_s", fmt::format("must be 0 to 1 (is {})", default_exposure_s));
  detector.check();
}

}  // namespace apriltrack
