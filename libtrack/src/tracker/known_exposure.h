#pragma once

#include <cmath>
#include <optional>

namespace apriltrack {

/// What is told of the frame, else of the camera; NaN, infinite or negative says nothing.
inline std::optional<double> known_exposure_s(std::optional<double> of_frame,
                                              std::optional<double> of_camera) {
  for (const std::optional<double>& exposure_s : {of_frame, of_camera})
    if (exposure_s && std::isfinite(*exposure_s) && *exposure_s >= 0.0) return exposure_s;
  return std::nullopt;
}

}  // namespace apriltrack
