#pragma once

#include <Eigen/Core>

namespace apriltrack {

/// How much longer than assumed a path was: the blur's over the one that poses show, which knows no exposure.
struct PathRatio {
  double ratio = 0.0;     ///< > 0
  double variance = 0.0;  ///< Of its logarithm: of the motion between the poses, and of what the blur says.
};

/// What the motion says of the exposure: the density of its logarithm, on a grid
/// (docs/algorithms/blur_tracker.md, section 4). Starts with what is known of it; forgets what it saw long
/// ago, for an unknown exposure may change with the light.
class ExposureEstimate {
 public:
  /// sigma: of the logarithm of true over assumed exposure. Beside it, a few are off by factors.
  explicit ExposureEstimate(double sigma);

  void observe(const PathRatio& seen);
  /// It cannot be longer than this times what is assumed: the frames' interval. Requires factor > 0.
  void limit(double factor);

  /// True over assumed exposure: exactly 1 before anything was observed, within the limit.
  double factor() const { return factor_; }
  /// Standard deviation of its logarithm.
  double sigma() const { return sigma_; }
  bool has_observed() const { return has_observed_; }

 private:
  void summarise();

  static constexpr Eigen::Index kSize = 321;  // factors from 1/25 to 25, 2 % apart
  Eigen::Array<double, kSize, 1> log_prior_;
  Eigen::Array<double, kSize, 1> log_seen_ = Eigen::Array<double, kSize, 1>::Zero();
  double limit_;
  double factor_ = 1.0;
  double sigma_;
  bool has_observed_ = false;
};

}  // namespace apriltrack
