#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "apriltrack/image/image.h"
#include "apriltrack/image/response.h"

namespace apriltrack {

/// Linear light of a raw image at any point.
class LightSampler {
 public:
  LightSampler(const GrayView& image, const ResponseCurve& response)
      : image_(image), light_(response.linear_light()) {}

  int width() const { return image_.width(); }
  int height() const { return image_.height(); }
  double of_pixel(int x, int y) const { return static_cast<double>(light_[image_.row(y)[x]]); }

  /// Between the four pixels around; nullopt outside the image.
  std::optional<double> at(const Eigen::Vector2d& point) const {
    const double x = std::floor(point.x());
    const double y = std::floor(point.y());
    if (!(x >= 0.0 && y >= 0.0 && x + 1.0 < image_.width() && y + 1.0 < image_.height())) return std::nullopt;
    const std::uint8_t* upper = image_.row(static_cast<int>(y)) + static_cast<int>(x);
    const std::uint8_t* lower = upper + image_.stride();
    const double fx = point.x() - x;
    const double fy = point.y() - y;
    const double top = light_[upper[0]] + fx * (light_[upper[1]] - light_[upper[0]]);
    const double bottom = light_[lower[0]] + fx * (light_[lower[1]] - light_[lower[0]]);
    return top + fy * (bottom - top);
  }

 private:
  GrayView image_;
  const std::array<float, 256>& light_;
};

}  // namespace apriltrack
