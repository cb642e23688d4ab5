#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats.h"

namespace apriltrack {
namespace {

/// What a calibration's corners err by in a bad picture, some times what they err by on average (0.2 to 0.5
/// px RMS are usual). A calibration whose optimiser was let turn the axes of a sensor, which are at a right
/// angle to 1e-5, has fitted its noise with them: the skew is of this size.
constexpr double kMaxSkewEffect_px = 1.0;

/// Largest |skew * y'| of the picture, y' = (y - cy) / fy; of a picture of unknown size that is centred on
/// the principal point.
double largest_effect_px(double skew_px, const Camera& camera) {
  const Pinhole& lens = camera.model.pinhole();
  const double bottom = camera.height > 0 ? camera.height - 1.0 : 2.0 * lens.cy;
  return std::abs(skew_px) * std::max(std::abs(lens.cy), std::abs(bottom - lens.cy)) / lens.fy;
}

constexpr const char* kWayOut =
    "calibrate without skew (ROS: cameracalibrator --fisheye-fix-skew; OpenCV: CALIB_FIX_SKEW)";

}  // namespace

void pass_over_skew(double skew_px, const Camera& camera, const YamlNode& node,
                    std::vector<ConversionLoss>& lost) {
  if (skew_px == 0.0) return;
  const double effect_px = largest_effect_px(skew_px, camera);
  if (effect_px > kMaxSkewEffect_px) {
    node.fail(fmt::format(
        "a skew of {} pixels moves points of the picture by up to {:.2f} px, and is not supported "
        "(without it, up to {} px pass); {}",
        skew_px, effect_px, kMaxSkewEffect_px, kWayOut));
  }
  lost.push_back({.kind = LossKind::kSkew,
                  .value = node.where() + ": " + node.key_path(),
                  .numbers = {skew_px, effect_px}});
}

std::string sentence_of_skew(const ConversionLoss& loss) {
  return fmt::format(
      "{}: a skew of {} pixels is passed over; points move by up to {:.2f} px, at the top and bottom of the "
      "picture; {}",
      loss.value, loss.numbers.at(0), loss.numbers.at(1), kWayOut);
}

}  // namespace apriltrack
