#pragma once

#include <cmath>
#include <numbers>

namespace apriltrack::test {

/// What pixels show of steps of light behind a Gaussian lens: the mean over a unit square of a blurred step,
/// in closed form. The normal distribution integrated once and twice.
class BlurredStep {
 public:
  explicit BlurredStep(double sigma_px) : sigma_(sigma_px) {}

  /// Dark below 0, 1 above, along the columns or the rows; x: of the pixel's centre.
  double upright(double x) const { return once(x + 0.5) - once(x - 0.5); }
  double slope(double x) const { return below(x + 0.5) - below(x - 0.5); }  ///< Of upright().

  /// The mean over a box of these widths along the step's normal, which is the mean over a turned pixel, or
  /// over the pixel and an even motion.
  double over_boxes(double x, double a, double b) const {
    const double sum = 0.5 * (a + b);
    const double difference = 0.5 * (a - b);
    return (twice(x + sum) - twice(x + difference) - twice(x - difference) + twice(x - sum)) / (a * b);
  }

 private:
  double below(double x) const { return 0.5 * std::erfc(-x / (sigma_ * std::numbers::sqrt2)); }
  double density(double x) const {
    return std::exp(-0.5 * x * x / (sigma_ * sigma_)) / std::sqrt(2.0 * std::numbers::pi);
  }
  double once(double x) const { return x * below(x) + sigma_ * density(x); }
  double twice(double x) const {
    return 0.5 * ((x * x + sigma_ * sigma_) * below(x) + x * sigma_ * density(x));
  }

  double sigma_;
};

}  // namespace apriltrack::test
