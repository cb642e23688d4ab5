#include "apriltrack/camera/rolling_shutter.h"

#include <fmt/format.h>

#include <cmath>

namespace apriltrack {

std::optional<std::string> rolling_shutter_warning(const Camera& camera) {
  if (camera.line_delay_s == 0.0) return std::nullopt;
  std::string text = fmt::format(
      "camera '{}' has a rolling shutter (line_delay {:g} us), which is not modelled yet: all rows "
      "are taken for one moment's, so that in motion corners far from the middle row are wrong",
      camera.name, 1e6 * camera.line_delay_s);
  if (camera.height == 0) return text;
  constexpr double kMotion_px = 10.0;  // between frames, for an example
  constexpr double kRate_hz = 30.0;
  const double half_readout_s = 0.5 * camera.height * std::abs(camera.line_delay_s);
  return text +
         fmt::format(
             " by up to what the picture moves in {:.1f} ms (at {:g} px a frame and {:g} Hz: {:.1f} px)",
             1e3 * half_readout_s, kMotion_px, kRate_hz, kMotion_px * kRate_hz * half_readout_s);
}

}  // namespace apriltrack
