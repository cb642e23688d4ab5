#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "apriltrack/base/normal_table.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {

/// A Gaussian blur in a tag's plane, in half tag sizes.
struct PatternBlur {
  double sigma_u = 0.0, sigma_v = 0.0;  ///< Above 0.
  double covariance_uv = 0.0;           ///< Not 0 where an oblique plane is smeared along neither axis.

  double correlation() const { return std::abs(covariance_uv) / (sigma_u * sigma_v); }
  static PatternBlur of(const Eigen::Matrix2d& covariance) {
    return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), covariance(0, 1)};
  }
};

/// The sides of a printed tag.
enum PatternSide { kLeftSide, kRightSide, kTopSide, kBottomSide, kNumPatternSides };

/// A point of a tag's plane as a lens shows it: its brightness, from 0 for black to 1 for white, and the
/// derivatives of that by the point, in half tag sizes.
///
/// By the heat equation the second derivatives are those by the blur as well:
/// d light = 1/2 by_uu d(sigma_u^2) + by_uv d(covariance_uv) + 1/2 by_vv d(sigma_v^2).
struct PatternSample {
  double light = 0.0;
  double by_u = 0.0, by_v = 0.0;
  double by_uu = 0.0, by_uv = 0.0, by_vv = 0.0;
  /// Share of the blur that lies on printed cells. `light` takes what lies elsewhere for white paper.
  double known = 0.0;
  /// Shares of the blur that lie beyond each side of the print; at the corners they overlap.
  std::array<double, kNumPatternSides> beyond = {};

  /// How the light changes with the blur's covariance, which changes so.
  double by_covariance(const Eigen::Matrix2d& change) const {
    return 0.5 * (by_uu * change(0, 0) + by_vv * change(1, 1)) + by_uv * change(0, 1);
  }
};

/// The printed cells of a tag under a Gaussian blur, in closed form along the axes of the plane
/// (docs/algorithms/photometric_refinement.md, equations 1 and 2). Coordinates in half tag sizes, as
/// TagPattern's.
class BlurredPattern {
 public:
  explicit BlurredPattern(const TagPattern& pattern);

  PatternSample at(double u, double v, const PatternBlur& blur) const;
  /// Half the width of the printed cells.
  double half_extent() const { return -begin_; }
  double cell_size() const { return cell_; }
  /// Whether there is a cell that the family leaves to the printer.
  bool has_unknown_cells() const { return has_unknown_cells_; }

  /// On the square grid of places x places.
  struct Grid {
    Eigen::MatrixXd light, known;  ///< As PatternSample's; rows along v, columns along u.
    /// By sides of PatternSide: what lies beyond them at each place along their axis.
    Eigen::Matrix<double, kNumPatternSides, Eigen::Dynamic> beyond;
  };
  Grid on_grid(const Eigen::VectorXd& places, const PatternBlur& blur) const;

 private:
  PatternSample smeared_along_axes(double u, double v, const PatternBlur& blur) const;

  double begin_ = 0.0, cell_ = 0.0;  ///< Where the first cell begins, and how wide each is.
  int num_cells_ = 0;                ///< Along each axis.
  bool has_unknown_cells_ = false;
  using Cells = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Cells black_;  ///< 1 - brightness, by rows along v; 0 where nothing is printed.
  Cells known_;  ///< 1 where something is printed, else 0.
};

}  // namespace apriltrack
