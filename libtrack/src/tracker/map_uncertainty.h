#pragma once

#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "tag_observation.h"

namespace apriltrack {

/// What the tags' covariances in the map do to a least-squares pose, to first order.
struct MapUncertainty {
  /// Of the right perturbation of T_camera_map; zero when no tag has a covariance.
  Matrix6d covariance = Matrix6d::Zero();
  /// Share of the corners' squared error, whitened, that tags at wrong places leave, to be expected after the
  /// fit.
  double squared_error = 0.0;
};

/// observations: the corners on which the pose rests, weighed by their covariances. inverse_information: that
/// of corner_information() over them. The tags' errors are taken as independent of each other: a map file
/// keeps no more.
MapUncertainty map_uncertainty(const CameraModel& model,
                               const std::vector<const TagObservation*>& observations,
                               const Pose& T_camera_map, const Matrix6d& inverse_information);

}  // namespace apriltrack
