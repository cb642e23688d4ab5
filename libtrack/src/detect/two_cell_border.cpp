#include "two_cell_border.h"

#include <Eigen/Geometry>
#include <cmath>

#include "apriltrack/geometry/homography.h"
#include "apriltrack/tags/tag_family.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

constexpr int kSamplesPerSide = 40;  // a whole number for each cell of both patterns

/// Sums for the correlation of light with a pattern.
class Correlation {
 public:
  void add(double light, double pattern) {
    ++count_;
    light_ += light;
    pattern_ += pattern;
    light_squared_ += light * light;
    pattern_squared_ += pattern * pattern;
    product_ += light * pattern;
  }
  double value() const {
    const double covariance = count_ * product_ - light_ * pattern_;
    const double variances =
        (count_ * light_squared_ - light_ * light_) * (count_ * pattern_squared_ - pattern_ * pattern_);
    return variances > 0.0 ? covariance / std::sqrt(variances) : 0.0;
  }

 private:
  double count_ = 0.0, light_ = 0.0, pattern_ = 0.0;
  double light_squared_ = 0.0, pattern_squared_ = 0.0, product_ = 0.0;
};

}  // namespace

bool has_two_cell_border(const LightSampler& light, int id, const Quad& corners_px) {
  const auto homography = estimate_homography(kTagQuad, corners_px);
  if (!homography) return false;
  const TagPattern one_cell = TagFamily::get("tag36h11").pattern(id);
  const TagPattern two_cells = TagFamily::get("tag36h11b2").pattern(id);
  Correlation as_one_cell, as_two_cells;
  for (int row = 0; row < kSamplesPerSide; ++row) {
    for (int column = 0; column < kSamplesPerSide; ++column) {
      const Eigen::Vector2d point =
          Eigen::Vector2d(2 * column + 1, 2 * row + 1) / kSamplesPerSide - Eigen::Vector2d::Ones();
      const auto seen = light.at((*homography * point.homogeneous()).hnormalized());
      if (!seen) continue;
      as_one_cell.add(*seen, one_cell.brightness(point.x(), point.y()));
      as_two_cells.add(*seen, two_cells.brightness(point.x(), point.y()));
    }
  }
  return as_two_cells.value() > as_one_cell.value();
}

}  // namespace apriltrack
