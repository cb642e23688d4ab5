#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// Where the rig was at one time.
struct RigPose {
  Timestamp timestamp;
  Pose T_map_rig;
};

/// A tag in an image that a map was made from, and how well it fits.
struct MappedView {
  int tag = 0;     ///< Into TagMap::tags.
  int moment = 0;  ///< Into MapEvidence::moments.
  int camera = 0;  ///< Into CalibrationResult::rig.
  Pose T_camera_tag;
  std::array<Eigen::Vector2d, kNumCorners> corners_px;  ///< As seen.
  /// Where the map puts the corners, less where they were seen.
  std::array<Eigen::Vector2d, kNumCorners> residuals_px;
  /// The same as numbers that are independent and of unit variance where the noise is as measured.
  Eigen::Matrix<double, 8, 1> whitened;
};

/// Noise of corners: as expected, and how much larger it was measured (docs/algorithms/calibration.md,
/// equation 5).
struct CornerNoise {
  double sigma_px = 0.15;
  double end_correlation = -0.45;
  double sum_scale = 1.0;  ///< Of errors that both ends of an edge share.
  double difference_scale = 1.0;
};

/// What a map rests on.
struct MapEvidence {
  std::vector<RigPose> moments;   ///< In the order of time.
  std::vector<MappedView> views;  ///< Those that were not rejected, in the order of moments.
  std::vector<int> rejected;      ///< Views that were, of each tag of the map.
  CornerNoise noise;
  JointCovariance joint;  ///< By corners alone.
};

}  // namespace apriltrack
