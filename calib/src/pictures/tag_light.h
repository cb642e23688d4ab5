#pragma once

#include <Eigen/Core>
#include <vector>

namespace apriltrack {

/// How the light that falls on a tag differs from place to place of it: a factor about 1, on a grid of half
/// cells, bilinear between. What a tag keeps in all of its views (a lamp beside it, a shadow, a smudge,
/// uneven paper) bends no edge then.
class TagLight {
 public:
  /// half_extent: of the printed cells, in half tag sizes; num_cells: across them.
  TagLight(double half_extent, int num_cells);

  /// At a place of the tag's plane, in half tag sizes.
  double factor(double u, double v) const;

  /// What pixels say of the factors that they were predicted with.
  class Sums {
   public:
    explicit Sums(const TagLight& light) : push_(light.size()), weight_(light.size()) {}
    /// white: light of the pixel where the factor is 1, but for the black's share. residual: seen minus
    /// predicted. weight: 1 over the residual's variance.
    void add(const TagLight& light, double u, double v, double white, double residual, double weight);

   private:
    friend class TagLight;
    std::vector<double> push_, weight_;
  };

  /// Takes over what the sums say, smoothed: nodes that see little of the white follow their neighbours. A
  /// step on the diagonal of the equations, neighbours counted in full: never too long, even where poses step
  /// at once.
  void update(const Sums& sums);

 private:
  struct Corners {
    std::size_t first;  ///< Of the four nodes about a place, the first; the others are at + 1, + n, + n + 1.
    Eigen::Vector4d shares;
  };
  Corners corners_about(double u, double v) const;
  std::size_t size() const { return static_cast<std::size_t>(excess_.size()); }
  double mean_of_neighbours(int column, int row, int* count) const;

  double half_extent_;
  double nodes_per_unit_;
  int num_nodes_;           ///< Along each axis.
  Eigen::VectorXd excess_;  ///< Factor minus 1, row by row.
};

}  // namespace apriltrack
