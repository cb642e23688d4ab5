#pragma once

#include <optional>
#include <string>

namespace apriltrack {

/// The exposures that cameras have, in seconds. Commercial video cameras go down to 500 ns (Young, Gerbrands,
/// van Vliet: Fundamentals of Image Processing, TU Delft, "Shutter Speeds"); what is far below, or above a
/// second, was given in another unit.
inline constexpr double kMinExposure_s = 1e-7;
inline constexpr double kMaxExposure_s = 1.0;

/// What is wrong with it, as the end of a sentence that begins with its name; nullopt when it is one of a
/// camera. One rule for camera files, frames.csv and renderings.
std::optional<std::string> fault_of_exposure(double exposure_s);

}  // namespace apriltrack
