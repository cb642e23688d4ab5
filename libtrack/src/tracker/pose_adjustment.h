#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "tag_observation.h"

namespace apriltrack {

using CornerErrors = Eigen::Matrix<double, 2 * kNumCorners, 1>;

/// How much a corner's whitened error counts (Zhang, "Parameter estimation techniques: a tutorial", 1997).
struct RobustKernel {
  enum class Shape {
    kCauchy,  ///< Forgets what is far off: for the search, while wrong tags may be among the right ones.
    kHuber,   ///< Least squares with a limit on the pull of a single corner: for the last fit.
  };
  Shape shape = Shape::kHuber;
  double scale = 1.0;  ///< In standard deviations.

  double cost(double squared_error) const;
  double weight(double squared_error) const;
};

/// Reprojection errors of a tag's four corners, x0 y0 x1 y1 ...; nullopt when one of them cannot be seen with
/// this pose, or the tag would be seen from behind.
std::optional<CornerErrors> corner_errors_px(const CameraModel& model, const TagObservation& observation,
                                             const Pose& T_camera_map);

/// Squared norm of the whitened corner_errors_px(); infinite where there are none.
double squared_error(const CameraModel& model, const TagObservation& observation, const Pose& T_camera_map);

/// Sum over all corners, whitened; a corner that cannot be seen counts as 1000 px off, so that the optimum
/// cannot hide there.
double robust_cost(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                   const RobustKernel& kernel, const Pose& T_camera_map);

/// The local minimum of robust_cost that Levenberg-Marquardt reaches from `T_camera_map`.
Pose adjust_pose(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                 const RobustKernel& kernel, Pose T_camera_map);

/// Sum of J' S^-1 J over all tags, J = d corners / d xi of `T_camera_map * exp(xi)`, S the corners'
/// covariance: the information on the right perturbation.
Matrix6d corner_information(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                            const Pose& T_camera_map);

}  // namespace apriltrack
