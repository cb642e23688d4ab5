#pragma once

#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_assessment.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

inline constexpr double kWeakRotation_rad = 0.02;
inline constexpr double kWeakPosition = 0.1;  ///< Of the tag's size.

/// The larger of position over a tenth of the size, and rotation over 0.02 rad, in their weakest directions.
double weakness_of(const Matrix6d& covariance, double size_m);

/// For each tag of `joint` that is seen together with another.
std::vector<WeakDirection> weak_directions(const TagMap& map, const JointCovariance& joint,
                                           const MapEvidence& evidence,
                                           const std::vector<SeenTogether>& links);

}  // namespace apriltrack
