#include "pattern_pixels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tag_quad.h"

namespace apriltrack {
namespace {

/// How far from an edge its blur shows, in its sigmas.
constexpr double kEdgeReach = 2.0;
/// Of the pixels where nothing changes, which tell light and noise alone, so many of those near edges'
/// density.
constexpr double kFlatShare = 0.15;
/// Tags move while they are fitted; so far about its first place the lens is kept.
constexpr int kKept_px = 8;

/// In [0, 1), even over the pixels at every density: a lattice of the plastic number's powers (Roberts 2018).
double lattice_place(int x, int y) {
  const double place = 0.7548776662466927 * x + 0.5698402909980532 * y;
  return place - std::floor(place);
}

/// Whether there is black and white within `reach` (along u, along v) of a point.
bool is_near_edge(const TagPattern& pattern, const Eigen::Vector2d& uv, const Eigen::Vector2d& reach) {
  const double here = pattern.brightness(uv.x(), uv.y());
  return pattern.brightness(uv.x() - reach.x(), uv.y()) != here ||
         pattern.brightness(uv.x() + reach.x(), uv.y()) != here ||
         pattern.brightness(uv.x(), uv.y() - reach.y()) != here ||
         pattern.brightness(uv.x(), uv.y() + reach.y()) != here;
}

/// Of a printed tag's area, about, what lies within `reach_cells` of an edge: half of the cells' borders are
/// edges.
double share_near_edges(double reach_cells) {
  const double flat = 1.0 - std::min(1.0, reach_cells);  // along one axis
  return 1.0 - flat * flat;
}

}  // namespace

StraightGrid::StraightGrid(const TagPlaces& places, int x0, int y0, int x1, int y1)
    : places_(places), x0_(x0), y0_(y0), columns_((x1 - x0) / kStep + 2), rows_((y1 - y0) / kStep + 2) {
  if (places.is_straightened())
    nodes_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

const std::optional<Eigen::Vector2d>& StraightGrid::node(int column, int row) {
  Node& node = nodes_[static_cast<std::size_t>(row * columns_ + column)];
  if (!node.is_known)
    node = {true, places_.straight(Eigen::Vector2d(x0_ + column * kStep, y0_ + row * kStep))};
  return node.straight;
}

std::optional<Eigen::Vector2d> StraightGrid::at(int x, int y) {
  if (nodes_.empty()) return Eigen::Vector2d(x, y);
  const int column = (x - x0_) / kStep, row = (y - y0_) / kStep;
  if (x < x0_ || y < y0_ || column + 1 >= columns_ || row + 1 >= rows_)
    return places_.straight(Eigen::Vector2d(x, y));
  const double fx = static_cast<double>((x - x0_) % kStep) / kStep;
  const double fy = static_cast<double>((y - y0_) % kStep) / kStep;
  const auto &a = node(column, row), &b = node(column + 1, row);
  const auto &c = node(column, row + 1), &d = node(column + 1, row + 1);
  if (!a || !b || !c || !d) return places_.straight(Eigen::Vector2d(x, y));
  return Eigen::Vector2d((1.0 - fy) * ((1.0 - fx) * *a + fx * *b) + fy * ((1.0 - fx) * *c + fx * *d));
}

std::optional<TagPlaces> TagPlaces::about(const Eigen::Vector2d& middle_px, const CameraModel* camera) {
  TagPlaces places(middle_px);
  if (!camera) return places;
  places.view_ = StraightView::about(middle_px, *camera);
  if (!places.view_) return std::nullopt;
  return places;
}

std::optional<Eigen::Vector2d> TagPlaces::straight(const Eigen::Vector2d& pixel) const {
  return view_ ? view_->straight(pixel) : pixel;
}

std::optional<Eigen::Vector2d> TagPlaces::pixel(const Eigen::Vector2d& straight,
                                                Eigen::Matrix2d* derivative) const {
  if (view_) return view_->pixel(straight, derivative);
  if (derivative) derivative->setIdentity();
  return straight;
}

Eigen::Matrix2d TagPlaces::straight_by_pixel() const {
  return view_ ? view_->straight_by_pixel() : Eigen::Matrix2d(Eigen::Matrix2d::Identity());
}

Eigen::Matrix2d projective_derivative(const Eigen::Matrix3d& map, const Eigen::Vector3d& image) {
  const double per_z = 1.0 / image.z();
  const Eigen::Vector2d at = image.head<2>() * per_z;
  return (map.topLeftCorner<2, 2>() - at * map.block<1, 2>(2, 0)) * per_z;
}

double quad_area(const Quad& quad) {
  double twice = 0.0;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const Eigen::Vector2d &a = quad[k], &b = quad[(k + 1) % kNumCorners];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

std::vector<PatternPixel> PatternPixels::pick(const Eigen::Matrix3d& straight_from_tag, double blur_sigma_px,
                                              double max_pixels) {
  const double reach_px = 0.5 + blur_sigma_px;
  Quad print;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const Eigen::Vector3d corner = straight_from_tag * (pattern_.half_extent() * kTagQuad[k]).homogeneous();
    const auto pixel = places_.pixel(corner.hnormalized(), nullptr);
    if (!(corner.z() > 0.0) || !pixel || !pixel->allFinite()) return {};
    print[k] = *pixel;
    low = low.cwiseMin(*pixel);
    high = high.cwiseMax(*pixel);
  }
  const int x0 = std::max(0, static_cast<int>(std::floor(std::max(-1.0, low.x() - reach_px))));
  const int y0 = std::max(0, static_cast<int>(std::floor(std::max(-1.0, low.y() - reach_px))));
  const int x1 = static_cast<int>(std::ceil(std::min(light_.width() - 1.0, high.x() + reach_px)));
  const int y1 = static_cast<int>(std::ceil(std::min(light_.height() - 1.0, high.y() + reach_px)));
  if (x1 < x0 || y1 < y0) return {};
  if (!grid_) grid_.emplace(places_, x0 - kKept_px, y0 - kKept_px, x1 + kKept_px, y1 + kKept_px);
  Eigen::Matrix3d tag_from_straight = straight_from_tag.inverse();
  if ((tag_from_straight * places_.middle().homogeneous()).z() < 0.0) tag_from_straight = -tag_from_straight;
  const double area = quad_area(print);
  const double cell_px = std::sqrt(area) / pattern_.cells().width();
  const double edge_px = kEdgeReach * blur_sigma_px + 0.5;
  const double of_edges = share_near_edges(edge_px / cell_px);
  const double share = max_pixels / area / (of_edges + kFlatShare * (1.0 - of_edges));
  std::vector<PatternPixel> pixels;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const double turn = lattice_place(x, y);
      if (turn >= share) continue;
      const std::optional<Eigen::Vector2d> straight = grid_->at(x, y);
      if (!straight) continue;
      const Eigen::Vector3d image = tag_from_straight * straight->homogeneous();
      if (!(image.z() > 0.0)) continue;
      const Eigen::Vector2d uv = image.head<2>() / image.z();
      const Eigen::Vector2d per_px = projective_derivative(tag_from_straight, image).rowwise().norm();
      if (uv.cwiseAbs().maxCoeff() - pattern_.half_extent() > reach_px * per_px.maxCoeff()) continue;
      if (turn >= kFlatShare * share && share < 1.0 && !is_near_edge(pattern_, uv, edge_px * per_px))
        continue;
      pixels.push_back({*straight, light_.of_pixel(x, y), x, y});
    }
  }
  return pixels;
}

}  // namespace apriltrack
