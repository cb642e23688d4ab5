#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "apriltrack/camera/camera_model.h"

namespace apriltrack {

/// OpenCV's lens with all of its 14 terms, of which ours has the first eight: k1 k2 p1 p2 k3 k4 k5 k6, then
/// s1..s4 (thin prism) and tau_x tau_y (tilted sensor, radians). opencv/opencv: the head comment of
/// modules/calib3d/include/opencv2/calib3d.hpp has the formulas.
class OpenCvLens {
 public:
  /// At most 14 coefficients; those that are missing are 0.
  OpenCvLens(const Pinhole& pinhole, const std::vector<double>& coefficients);

  /// Whether a term is not 0 that ours has not.
  bool has_further_terms() const;
  /// Pixel of the point (x, y, 1) of the camera frame.
  Eigen::Vector2d project(const Eigen::Vector2d& plane) const;
  /// Without the further terms.
  CameraModel first_eight() const;

 private:
  Pinhole pinhole_;
  std::array<double, 14> k_{};
  RadtanDistortion eight_;
  Eigen::Matrix3d tilt_;  ///< Of homogeneous points of the distorted plane.
};

/// The radtan camera of eight coefficients that is nearest to a lens, and how near.
struct RadtanFit {
  CameraModel model;
  double max_error_px = 0.0;  ///< Over the picture.
  double rms_error_px = 0.0;
};

/// Least squares of the pixels of some 1000 points, evenly over the picture. A place of the picture that the
/// model does not reach counts as an error without bound.
RadtanFit fit_radtan(const OpenCvLens& lens, int width, int height);

}  // namespace apriltrack
