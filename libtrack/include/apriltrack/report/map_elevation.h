#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// A projection of a map onto paper: which directions of the map's frame are right and up there.
struct Elevation {
  std::string name;           ///< "From above".
  Eigen::Vector3d right, up;  ///< Of length 1, in the map's frame, at right angles.

  /// Metres to the right and up, of a point of the map's frame in metres.
  Eigen::Vector2d of(const Eigen::Vector3d& point) const { return {right.dot(point), up.dot(point)}; }
  /// Of a position's covariance along the map's axes, m^2.
  Eigen::Matrix2d of(const Eigen::Matrix3d& covariance) const;
};

/// From above and from two sides. Walls that most tags hang on lie along the paper's edges.
struct Elevations {
  Elevation above, front, side;
};
/// up: in the map's frame, of length 1. Walls are found by the tags' normals.
Elevations elevations_of(const TagMap& map, const Eigen::Vector3d& up);

/// Scale from metres of an elevation to the units of a picture, whose y is down: the same along both axes.
class PaperScale {
 public:
  /// Holds all points, with a margin, in a picture as wide as `width` or, where it would be higher than
  /// `max_height`, less wide. Requires points.
  PaperScale(const std::vector<Eigen::Vector2d>& points, double width, double max_height, double margin);

  double width() const { return width_; }
  double height() const { return height_; }
  double units_per_m() const { return units_per_m_; }
  Eigen::Vector2d at(const Eigen::Vector2d& point_m) const {
    return {origin_.x() + units_per_m_ * point_m.x(), origin_.y() - units_per_m_ * point_m.y()};
  }
  /// Lowest and highest of what the picture holds, in metres.
  Eigen::Vector2d low_m() const;
  Eigen::Vector2d high_m() const;

 private:
  double width_, height_, units_per_m_ = 1.0;
  Eigen::Vector2d origin_;
};

/// 1, 2 or 5 times a power of ten, not above `value`.
double round_number_below(double value);

}  // namespace apriltrack
