#pragma once

#include <span>
#include <vector>

#include "apriltrack/calib/calibration_result.h"
#include "apriltrack/calib/map_assessment.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// map, joint: as calibrated, or as refined. evidence: of that map's tags. Quick beside the calibration, for
/// maps of any size: without a joint covariance there are links and hanging parts alone.
MapAssessment assess_map(const TagMap& map, const JointCovariance& joint, const MapEvidence& evidence,
                         const CameraRig& rig);

/// Covariance of each tag of `joint` (by its noise and by what tags keep) after `pictures` more pictures from
/// T_map_camera, as far as these show two tags of the map or more. In the order of joint.tags. Requires
/// a camera whose resolution is known.
std::vector<Matrix6d> covariances_after(const TagMap& map, const JointCovariance& joint,
                                        const MapEvidence& evidence, const CameraRig& rig, int camera,
                                        const Pose& T_map_camera, int pictures);

/// For each part of its own, and each tag that was never seen together with another: the two tags that were
/// seen closest after each other, which most likely hang close to each other, too.
std::vector<JoinAdvice> advise_joining(const CalibrationResult& result,
                                       std::span<const FrameDetections> frames);

}  // namespace apriltrack
