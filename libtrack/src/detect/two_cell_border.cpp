#include "two_cell_border.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "apriltrack/geometry/homography.h"

namespace apriltrack {
namespace {

constexpr double kMaxBrightShare = 0.25;  // of the second ring; of a one-cell border's tag about half is

/// Tag coordinates of the corners.
const Quad kTagQuad = {Eigen::Vector2d(-1.0, 1.0), {1.0, 1.0}, {1.0, -1.0}, {-1.0, -1.0}};

/// Light at the centres of the cells of the square that the corners bound.
class CellSampler {
 public:
  CellSampler(const LightSampler& light, const Eigen::Matrix3d& homography, int width)
      : light_(light), homography_(homography), width_(width) {}

  Eigen::Vector2d centre(int column, int row) const {
    return Eigen::Vector2d(2 * column + 1, 2 * row + 1) / width_ - Eigen::Vector2d::Ones();
  }
  std::optional<double> at(int column, int row) const {
    return light_.at((homography_ * centre(column, row).homogeneous()).hnormalized());
  }
  int last() const { return width_ - 1; }
  /// 0 for the outermost cells.
  int ring(int column, int row) const { return std::min({column, row, last() - column, last() - row}); }

 private:
  const LightSampler& light_;
  const Eigen::Matrix3d& homography_;
  int width_;
};

/// Mean light of the code's white cells; nullopt when the image shows none.
std::optional<double> white_of_code(const CellSampler& cells, const TagPattern& pattern) {
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row <= cells.last(); ++row) {
    for (int column = 0; column <= cells.last(); ++column) {
      const Eigen::Vector2d centre = cells.centre(column, row);
      if (cells.ring(column, row) < 2 || pattern.brightness(centre.x(), centre.y()) < 0.5) continue;
      if (const auto light = cells.at(column, row)) {
        sum += *light;
        ++count;
      }
    }
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace

bool has_two_cell_border(const LightSampler& light, const TagPattern& pattern, const Quad& corners_px) {
  const auto homography = estimate_homography(kTagQuad, corners_px);
  if (!homography) return false;
  const CellSampler cells(light, *homography, pattern.width_at_border());
  const std::optional<double> white = white_of_code(cells, pattern);
  if (!white) return false;
  int bright = 0;
  int count = 0;
  for (int row = 1; row < cells.last(); ++row) {
    for (int column = 1; column < cells.last(); ++column) {
      if (cells.ring(column, row) != 1) continue;
      // The neighbour in the first ring, so that light which varies over the tag does not matter.
      const int outer_column = column == 1 ? 0 : column == cells.last() - 1 ? cells.last() : column;
      const int outer_row = row == 1 ? 0 : row == cells.last() - 1 ? cells.last() : row;
      const auto inner = cells.at(column, row);
      const auto outer = cells.at(outer_column, outer_row);
      if (!inner || !outer) continue;
      ++count;
      if (*inner - *outer > 0.5 * (*white - *outer)) ++bright;
    }
  }
  return count > 0 && bright <= kMaxBrightShare * count;
}

}  // namespace apriltrack
