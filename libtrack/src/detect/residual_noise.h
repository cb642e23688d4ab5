#pragma once

#include <Eigen/Core>
#include <vector>

namespace apriltrack {

/// A pixel's place in the image, and how the fit explains it.
struct FittedPixel {
  int x = 0, y = 0;
  double residual = 0.0;   ///< Weighted, as it acts on the fit; one of something else is near 0.
  bool counts = false;     ///< Whether the fit uses the pixel.
  double gradient2 = 0.0;  ///< Square of the predicted light's gradient, per px.
};

/// What a fit's residuals say of the noise that is left in the pixels.
///
/// It is larger where light changes (a lens that is no Gaussian, JPEG's rounding), s^2 = alpha + beta
/// gradient^2, and neighbours err alike: correlation c k(dx) k(dy) with k(d) = 0.8^|d| (1 - |d| / 5) up to 4
/// px, c as the residuals have it (docs/algorithms/detector.md, section 5). No sum has a negative variance.
class ResidualNoise {
 public:
  /// num_unknowns: that were fitted to the pixels.
  ResidualNoise(std::vector<FittedPixel> pixels, int num_unknowns);

  /// sum_ij cov(noise_i, noise_j) y_i y_j': the covariance of sum_i y_i noise_i. influence: y_i by columns,
  /// in the pixels' order.
  Eigen::Matrix<double, 8, 8> covariance_of_sum(Eigen::Matrix<double, 8, Eigen::Dynamic> influence) const;

 private:
  static constexpr int kReach_px = 4;

  void fit_variances(int num_unknowns);
  void fit_correlation();
  /// Calls visit(i, j, k(dx) k(dy)) for each pair of pixels near each other, once.
  template <class Visit>
  void for_pairs(const Visit& visit) const;

  std::vector<FittedPixel> pixels_;
  std::vector<int> index_;  ///< Of the pixels, on the rectangle that holds them; -1: none.
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
  Eigen::VectorXd sigmas_;
  double correlation_ = 0.0;  ///< c.
};

}  // namespace apriltrack
