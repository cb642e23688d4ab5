#pragma once

#include <array>
#include <vector>

#include "faults/tag_probe.h"
#include "model/tag_finding.h"

namespace apriltrack {

/// What each further unknown must gain, of half the sum of squares, to be preferred.
inline constexpr double kFeeOfUnknown = 2.0;

/// A tag as it might be: not quite as large as stated, not quite square, not quite flat.
struct TagShape {
  double size_m = 0.0;
  double log_scale = 0.0;  ///< Of both sides.
  double aspect = 0.0;     ///< Width over height is 1 + aspect.
  double twist = 0.0;      ///< Corners lie by this share of the size before and behind the plane, by turns.

  std::array<Eigen::Vector3d, 4> corners() const;
};

enum class ShapeFreedom {
  kNone,
  kSize,
  kBend  ///< Size, aspect and twist: a curled print is shorter along one side.
};

struct TagFit {
  Pose T_map_tag;
  TagShape shape;
  double cost = 0.0;                                                ///< Sum of probe_cost() by shares.
  Matrix6d covariance = Matrix6d::Zero();                           ///< Of the pose.
  double scale_sigma = 0.0, aspect_sigma = 0.0, twist_sigma = 0.0;  ///< Where they were free.
};

/// What the fit says of the tag's shape.
ShapeError shape_error_of(const TagFit& fit);

/// Robustly; from `start`.
TagFit fit_tag(const std::vector<ProbeView>& views, TagFit start, ShapeFreedom freedom);
/// From the best of the poses that the largest views propose. size_m: as stated.
TagFit fit_tag_anew(const std::vector<ProbeView>& views, double size_m);
/// The whitened residual's derivatives by a tag's scale, aspect and twist, where it is as stated; zero where
/// the tag cannot be projected.
Eigen::Matrix<double, 8, 3> residual_by_shape(const Observations& observations, const TagView& view,
                                              const MapState& state);
/// Of one view, nats: by Student's distribution where the detector claims covariances (noise_scale.h), by
/// Cauchy's loss else. A view that errs as expected costs usual_probe_cost() by either.
double probe_cost(const ProbeView& view, const Pose& T_map_tag, const TagShape& shape);
double usual_probe_cost();
/// Of all that the views count together.
double usual_cost_of(const std::vector<ProbeView>& views);
/// Of the whitened residual; infinite where the tag cannot be projected.
double probe_squares(const ProbeView& view, const Pose& T_map_tag, const TagShape& shape);
/// The cost of a view of so many squares, its share left out.
double cost_of_squares(const ProbeView& view, double squares);

}  // namespace apriltrack
