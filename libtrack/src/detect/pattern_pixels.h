#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <optional>
#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/tags/tag_family.h"
#include "edge_frame.h"
#include "light_sampler.h"
#include "straight_view.h"

namespace apriltrack {

/// Coordinates in which a tag is seen through a homography: straightened by the camera's lens about the tag,
/// or the image's own where no camera is known.
class TagPlaces {
 public:
  /// nullopt where the lens model has no ray at the middle.
  static std::optional<TagPlaces> about(const Eigen::Vector2d& middle_px, const CameraModel* camera);

  bool is_straightened() const { return view_.has_value(); }
  const Eigen::Vector2d& middle() const { return middle_; }  ///< The same in both.
  std::optional<Eigen::Vector2d> straight(const Eigen::Vector2d& pixel) const;
  /// derivative: d pixel / d straight, if asked.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector2d& straight, Eigen::Matrix2d* derivative) const;
  /// At the middle.
  Eigen::Matrix2d straight_by_pixel() const;

 private:
  explicit TagPlaces(const Eigen::Vector2d& middle_px) : middle_(middle_px) {}

  Eigen::Vector2d middle_;
  std::optional<StraightView> view_;
};

/// The pixels of an upright rectangle, straightened: exactly at the nodes of a grid, between them bilinear. A
/// lens of 1.2e-4 px of bend per px^2 errs by 2.4e-4 px over such a step.
class StraightGrid {
 public:
  StraightGrid(const TagPlaces& places, int x0, int y0, int x1, int y1);

  /// Outside the rectangle, too, but slowly. nullopt where the lens model has no ray.
  std::optional<Eigen::Vector2d> at(int x, int y);

 private:
  static constexpr int kStep = 4;
  struct Node {
    bool is_known = false;
    std::optional<Eigen::Vector2d> straight;
  };
  const std::optional<Eigen::Vector2d>& node(int column, int row);

  const TagPlaces& places_;
  int x0_, y0_, columns_, rows_;
  std::vector<Node> nodes_;
};

/// A pixel that may show the tag.
struct PatternPixel {
  Eigen::Vector2d straight;  ///< Its place, as TagPlaces has it.
  double light = 0.0;
  int x = 0, y = 0;
};

/// Derivative of the projective map `map` where it leads to `image`.
Eigen::Matrix2d projective_derivative(const Eigen::Matrix3d& map, const Eigen::Vector3d& image);

/// Area that a quad encloses.
double quad_area(const Quad& quad);

/// Picks pixels that show a tag. Keeps what it learns of the lens, for it is asked more than once.
class PatternPixels {
 public:
  /// Refers to all three.
  PatternPixels(const LightSampler& light, const TagPlaces& places, const TagPattern& pattern)
      : light_(light), places_(places), pattern_(pattern) {}

  /// Those that show the print, and those about it that its blur reaches; of large tags about `max_pixels`,
  /// most of them where edges between black and white are. blur: the pixel's own area included.
  std::vector<PatternPixel> pick(const Eigen::Matrix3d& straight_from_tag, double blur_sigma_px,
                                 double max_pixels);

 private:
  const LightSampler& light_;
  const TagPlaces& places_;
  const TagPattern& pattern_;
  std::optional<StraightGrid> grid_;
};

}  // namespace apriltrack
