#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// The camera's response: which linear light an 8-bit grey level stands for.
///
/// Blur adds up in linear light only, and an edge blurred in light but measured in sRGB codes seems to lie
/// 0.4 px inside the dark side; so corners are localised, and blur is modelled, after the response is undone.
class ResponseCurve {
 public:
  /// A measured curve; its name is "table", whatever it holds.  linear_light: light of each grey level, 0 at
  /// no light and 1 at full scale; must never decrease.
  explicit ResponseCurve(const std::array<float, 256>& linear_light);

  static ResponseCurve linear();
  /// The transfer curve of IEC 61966-2-1, which 8-bit image files use unless something else is said.
  static ResponseCurve srgb();
  /// light = (code / 255) ^ exponent; exponent in [0.2, 5].
  static ResponseCurve gamma(double exponent);

  /// "linear", "srgb", "gamma:2.2" or "table": what a camera file says. Only the functions above give the
  /// first three, so that the name stands for the curve.
  const std::string& name() const { return name_; }
  const std::array<float, 256>& linear_light() const { return linear_light_; }
  float to_linear(std::uint8_t code) const { return linear_light_[code]; }
  bool is_linear() const { return name_ == "linear"; }

 private:
  ResponseCurve(const std::array<float, 256>& linear_light, std::string name);

  std::array<float, 256> linear_light_;
  std::string name_;
};

/// Light in [0, 1] of every pixel.
Image<float> to_linear_light(const GrayView& image, const ResponseCurve& response);

/// Light re-quantised to 8 bits, full scale 255, rounded: for detectors that want bytes.
GrayImage to_linear_bytes(const GrayView& image, const ResponseCurve& response);

/// A picture in linear light as sRGB has it: dark parts keep their contrast beside bright ones.
GrayImage linear_to_srgb_bytes(const GrayView& image);

}  // namespace apriltrack
