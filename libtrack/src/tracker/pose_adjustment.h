#pragma once

#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "tag_observation.h"

namespace apriltrack {

/// How much a corner that is `error` off counts (Zhang, "Parameter estimation techniques: a tutorial", 1997).
struct RobustKernel {
  enum class Shape {
    kCauchy,  ///< Forgets what is far off: for the search, while wrong tags may be among the right ones.
    kHuber,   ///< Least squares with a limit on the pull of a single corner: for the last fit.
  };
  Shape shape = Shape::kHuber;
  double scale_px = 1.0;

  double cost(double squared_error_px2) const;
  double weight(double squared_error_px2) const;
};

/// Squared reprojection error of a tag's four corners, px^2; infinite when one of them cannot be seen with
/// this pose, or the tag would be seen from behind.
double squared_error_px2(const CameraModel& model, const TagObservation& observation,
                         const Pose& T_camera_map);

/// Sum over all corners; a corner that cannot be seen counts as 1000 px off, so that the optimum cannot hide
/// there.
double robust_cost(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                   const RobustKernel& kernel, const Pose& T_camera_map);

/// The local minimum of robust_cost that Levenberg-Marquardt reaches from `T_camera_map`.
Pose adjust_pose(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                 const RobustKernel& kernel, Pose T_camera_map);

/// Sum of J' J over all corners, J = d pixel / d xi of `T_camera_map * exp(xi)`: times 1 / sigma_px^2 it is
/// the information on the right perturbation.
Matrix6d corner_information(const CameraModel& model, const std::vector<const TagObservation*>& observations,
                            const Pose& T_camera_map);

}  // namespace apriltrack
