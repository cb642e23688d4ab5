#include "opencv_lens.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace apriltrack {
namespace {

/// The plane of a sensor that is turned by tau_x about x, then tau_y about y, seen from the lens.
Eigen::Matrix3d tilt_matrix(double tau_x_rad, double tau_y_rad) {
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(-tau_y_rad, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(-tau_x_rad, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  Eigen::Matrix3d onto_plane;
  onto_plane << R(2, 2), 0.0, -R(0, 2),  //
      0.0, R(2, 2), -R(1, 2),            //
      0.0, 0.0, 1.0;
  return onto_plane * R;
}

std::vector<double> resized(std::vector<double> coefficients, std::size_t size) {
  coefficients.resize(size, 0.0);
  return coefficients;
}

}  // namespace

OpenCvLens::OpenCvLens(const Pinhole& pinhole, const std::vector<double>& coefficients)
    : pinhole_(pinhole), eight_(resized(coefficients, 8)) {
  std::ranges::copy(resized(coefficients, k_.size()), k_.begin());
  tilt_ = tilt_matrix(k_[12], k_[13]);
}

bool OpenCvLens::has_further_terms() const {
  return std::any_of(k_.begin() + 8, k_.end(), [](double value) { return value != 0.0; });
}

CameraModel OpenCvLens::first_eight() const {
  return {pinhole_, eight_};
}

Eigen::Vector2d OpenCvLens::project(const Eigen::Vector2d& plane) const {
  const double s = plane.squaredNorm();
  const Eigen::Vector2d prism(s * (k_[8] + s * k_[9]), s * (k_[10] + s * k_[11]));
  const Eigen::Vector2d distorted = eight_.distort_continued(plane) + prism;
  const Eigen::Vector2d tilted = (tilt_ * distorted.homogeneous()).hnormalized();
  return {pinhole_.fx * tilted.x() + pinhole_.cx, pinhole_.fy * tilted.y() + pinhole_.cy};
}

}  // namespace apriltrack
