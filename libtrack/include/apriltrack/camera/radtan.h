#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace apriltrack {

/// Radial and tangential distortion (D. C. Brown, "Close-range camera calibration", 1971), in OpenCV's order
/// of coefficients k1 k2 p1 p2 [k3 [k4 k5 k6]].
///
/// With x = X/Z, y = Y/Z, s = x^2 + y^2:
///
///     f(s) = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)
///     x'   = x f + 2 p1 x y + p2 (s + 2 x^2)
///     y'   = y f + p1 (s + 2 y^2) + 2 p2 x y
///
/// Valid domain: Z > 0 and radius sqrt(s) < max_radius(). The polynomial rises only up to some radius and
/// then folds back, so that points far outside the picture would be shown inside it. (x', y') is the gradient
/// of `integral of r f dr + s (p2 x + p1 y)`, so its Jacobian is symmetric, with the eigenvalues f and d(r
/// f)/dr of the radial part moved by no more than 6 |p| r. max_radius() lies just inside (1e-4 of it) the
/// first radius at which one of them, so moved, is no longer positive: without tangential terms the first
/// fold d(r f)/dr = 0. Within that disc the potential is convex, hence the map is one-to-one. The disc also
/// ends where the radial part shows points at 1000, which is before any pole of f.
class RadtanDistortion {
 public:
  /// 4, 5 or 8 finite coefficients; throws Error(kInvalidInput) where they are not.
  explicit RadtanDistortion(const std::vector<double>& coefficients);

  /// As they were given.
  std::vector<double> coefficients() const { return {values_.begin(), values_.begin() + num_coefficients_}; }
  /// In units of the image plane, tangent of the angle from the axis; at most 1000, 89.94 degrees.
  double max_radius() const { return max_radius_; }

  /// jacobian: d result / d point, if asked.
  std::optional<Eigen::Vector2d> distort(const Eigen::Vector3d& point_camera,
                                         Eigen::Matrix<double, 2, 3>* jacobian = nullptr) const;
  /// Unit ray; solved to rounding error.
  std::optional<Eigen::Vector3d> undistort(const Eigen::Vector2d& distorted) const;
  /// Beyond the valid domain, too, where it folds back, or has a pole and is not finite.
  Eigen::Vector2d distort_continued(const Eigen::Vector2d& undistorted) const {
    return distort_plane(undistorted, nullptr);
  }

 private:
  struct Radial {
    double factor;  ///< f
    double slope;   ///< df/ds
  };
  Radial radial(double s) const;
  double find_max_radius() const;
  Eigen::Vector2d distort_plane(const Eigen::Vector2d& undistorted, Eigen::Matrix2d* jacobian) const;
  /// Point of the disc that is shown at `distorted`; nullopt when it lies outside.
  std::optional<Eigen::Vector2d> undistort_plane(const Eigen::Vector2d& distorted,
                                                 const Eigen::Vector2d& start) const;
  /// Radius that the radial part alone shows at `distorted_radius`; max_radius() if there is none.
  double undistort_radius(double distorted_radius) const;

  std::array<double, 8> values_{};
  int num_coefficients_ = 0;
  double max_radius_ = 0.0;
  double max_distorted_radius_ = 0.0;  ///< Of the radial part.
};

}  // namespace apriltrack
