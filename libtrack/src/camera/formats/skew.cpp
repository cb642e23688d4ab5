#include "apriltrack/camera/skew.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats.h"

namespace apriltrack {
namespace {

constexpr const char* kWayOut =
    "calibrate without skew (ROS: cameracalibrator --fisheye-fix-skew; OpenCV: CALIB_FIX_SKEW)";

}  // namespace

double largest_skew_effect_px(double skew_px, const Camera& camera) {
  const Pinhole& lens = camera.model.pinhole();
  const double bottom = camera.height > 0 ? camera.height - 1.0 : 2.0 * lens.cy;
  return std::abs(skew_px) * std::max(std::abs(lens.cy), std::abs(bottom - lens.cy)) / lens.fy;
}

void pass_over_skew(double skew_px, const Camera& camera, const YamlNode& node,
                    std::vector<ConversionLoss>& lost) {
  if (skew_px == 0.0) return;
  const double effect_px = largest_skew_effect_px(skew_px, camera);
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
