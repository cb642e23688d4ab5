#pragma once

#include <optional>

#include "apriltrack/image/exposure.h"

namespace apriltrack {

/// 0, an instant, or one of a camera.
inline bool is_exposure(double exposure_s) {
  return exposure_s == 0.0 || !fault_of_exposure(exposure_s);
}

/// What is told of the frame, else of the camera; what is none of a camera says nothing.
inline std::optional<double> known_exposure_s(std::optional<double> of_frame,
                                              std::optional<double> of_camera) {
  for (const std::optional<double>& exposure_s : {of_frame, of_camera})
    if (exposure_s && is_exposure(*exposure_s)) return exposure_s;
  return std::nullopt;
}

}  // namespace apriltrack
