#include "apriltrack/report/map_elevation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>

namespace apriltrack {
namespace {

Eigen::Vector3d any_level(const Eigen::Vector3d& up) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX() - up.x() * up;
  return x.norm() > 0.3 ? x.normalized() : up.cross(Eigen::Vector3d::UnitX()).normalized();
}

/// Level, and along or across most tags' walls: the mean of four times their angles.
Eigen::Vector3d along_walls(const TagMap& map, const Eigen::Vector3d& up) {
  const Eigen::Vector3d x = any_level(up), y = up.cross(x);
  std::complex<double> sum = 0.0;
  for (const MapTag& tag : map.tags) {
    const Eigen::Vector3d normal = tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ();
    const std::complex<double> level(normal.dot(x), normal.dot(y));
    sum +=
        std::pow(level, 4) / std::max(1e-9, std::pow(std::abs(level), 2));  // less, the less upright it hangs
  }
  const double angle = std::abs(sum) > 1e-6 ? std::arg(sum) / 4.0 : 0.0;
  return std::cos(angle) * x + std::sin(angle) * y;
}

}  // namespace

Eigen::Matrix2d Elevation::of(const Eigen::Matrix3d& covariance) const {
  Eigen::Matrix<double, 2, 3> axes;
  axes << right.transpose(), up.transpose();
  return axes * covariance * axes.transpose();
}

Elevations elevations_of(const TagMap& map, const Eigen::Vector3d& up) {
  const Eigen::Vector3d right = along_walls(map, up), back = up.cross(right);
  return {{"From above", right, back}, {"From the front", right, up}, {"From the right", back, up}};
}

PaperScale::PaperScale(const std::vector<Eigen::Vector2d>& points, double width, double max_height,
                       double margin)
    : width_(width), height_(0.0) {
  Eigen::Vector2d low = points.front(), high = points.front();
  for (const Eigen::Vector2d& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const Eigen::Vector2d size = (high - low).cwiseMax(0.05);
  units_per_m_ = std::min((width - 2.0 * margin) / size.x(), (max_height - 2.0 * margin) / size.y());
  height_ = units_per_m_ * size.y() + 2.0 * margin;
  const Eigen::Vector2d middle = 0.5 * (low + high);
  origin_ = {0.5 * width_ - units_per_m_ * middle.x(), 0.5 * height_ + units_per_m_ * middle.y()};
}

Eigen::Vector2d PaperScale::low_m() const {
  return {-origin_.x() / units_per_m_, (origin_.y() - height_) / units_per_m_};
}

Eigen::Vector2d PaperScale::high_m() const {
  return {(width_ - origin_.x()) / units_per_m_, origin_.y() / units_per_m_};
}

double round_number_below(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= value * (1.0 + 1e-9)) return factor * power;
  }
  return power;
}

}  // namespace apriltrack
