#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cstddef>
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

/// A pixel that may show the tag.
struct PatternPixel {
  Eigen::Vector2d straight;  ///< Its place, as TagPlaces has it.
  double light = 0.0;
  int x = 0, y = 0;
};

struct PatternPixels {
  std::vector<PatternPixel> all;
  std::size_t num_coarse = 0;  ///< The first so many are evenly spread by themselves.
};

/// Derivative of the projective map `map` where it leads to `image`.
Eigen::Matrix2d projective_derivative(const Eigen::Matrix3d& map, const Eigen::Vector3d& image);

/// Area that a quad encloses.
double quad_area(const Quad& quad);

/// The pixels that show the print, and those about it that its blur reaches; of large tags a part. blur: the
/// pixel's own area included.
PatternPixels collect_pixels(const LightSampler& light, const TagPlaces& places, const TagPattern& pattern,
                             const Eigen::Matrix3d& straight_from_tag, double blur_sigma_px);

}  // namespace apriltrack
