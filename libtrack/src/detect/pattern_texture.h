#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "apriltrack/tags/blurred_pattern.h"

namespace apriltrack {

/// A blurred pattern on a grid of the tag's plane: many times as fast to ask as BlurredPattern where the blur
/// is as wide as a good part of a cell.
///
/// Values between the nodes are those of cubic B-splines, which smear by h^2 / 3 along each axis themselves:
/// the nodes hold the pattern under that much less blur. A blur near the grid's own is taken into account to
/// first order, by the heat equation (PatternSample).
class PatternTexture {
 public:
  /// nullopt where a grid fine enough for the blur would be too large to pay. num_asked: pixels that will be.
  static std::optional<PatternTexture> of(const BlurredPattern& pattern, const Eigen::Matrix2d& covariance,
                                          std::size_t num_asked);

  const Eigen::Matrix2d& covariance() const { return covariance_; }
  /// covariance: of the blur at this place, about the grid's.
  PatternSample at(double u, double v, const Eigen::Matrix2d& covariance) const;

 private:
  PatternTexture() = default;

  Eigen::Matrix2d covariance_;
  double begin_ = 0.0, per_step_ = 1.0;  ///< Of the nodes, along both axes.
  int num_nodes_ = 0;
  Eigen::MatrixXd light_;  ///< At the nodes: rows along v, columns along u.
  Eigen::MatrixXd known_;  ///< Empty where all cells of the print are printed.
  Eigen::Matrix<double, kNumPatternSides, Eigen::Dynamic> beyond_;  ///< By node of the side's axis.
};

}  // namespace apriltrack
