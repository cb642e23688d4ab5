#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "apriltrack/detect/detection.h"

namespace apriltrack::test {

/// What a sharp tag's corners may be off: outwards from its middle on average, and per axis.
inline constexpr double kMaxBias_px = 0.03;
inline constexpr double kMaxRms_px = 0.16;

/// How far corners are from the truth: outwards from the tag's middle, and per axis.
class CornerStatistics {
 public:
  void add(const std::array<Eigen::Vector2d, kNumCorners>& corners_px,
           const std::array<Eigen::Vector2d, kNumCorners>& truth_px) {
    const Eigen::Vector2d middle = 0.25 * (truth_px[0] + truth_px[1] + truth_px[2] + truth_px[3]);
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const Eigen::Vector2d error = corners_px[k] - truth_px[k];
      radial_sum_ += error.dot((truth_px[k] - middle).normalized());
      sum_ += error;
      squares_ += error.squaredNorm();
      largest_ = std::max(largest_, error.norm());
      ++num_corners_;
    }
  }

  int num_tags() const { return num_corners_ / kNumCorners; }
  double radial_bias_px() const { return radial_sum_ / num_corners_; }
  Eigen::Vector2d mean_px() const { return sum_ / num_corners_; }
  double rms_per_axis_px() const { return std::sqrt(squares_ / (2 * num_corners_)); }
  double largest_px() const { return largest_; }

 private:
  int num_corners_ = 0;
  double radial_sum_ = 0.0;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
  double squares_ = 0.0;
  double largest_ = 0.0;
};

}  // namespace apriltrack::test
