#include "apriltrack/calib/assess_map.h"

#include "apriltrack/base/check.h"
#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"
#include "assess/map_links.h"
#include "assess/picture_equations.h"
#include "assess/view_advice.h"
#include "assess/weak_directions.h"

namespace apriltrack {

MapAssessment assess_map(const TagMap& map, const JointCovariance& joint, const MapEvidence& evidence,
                         const CameraRig& rig) {
  MapAssessment result;
  const std::vector<std::vector<int>> moments = tags_by_moment(evidence);
  result.links = links_of(moments);
  result.hanging = hanging_parts(map, moments, result.links);
  if (joint.is_empty()) return result;
  result.directions = weak_directions(map, joint, evidence, result.links);
  result.advice = advise_views(map, joint, evidence, rig);
  return result;
}

std::vector<Matrix6d> covariances_after(const TagMap& map, const JointCovariance& joint,
                                        const MapEvidence& evidence, const CameraRig& rig, int camera,
                                        const Pose& T_map_camera, int pictures) {
  APRILTRACK_CHECK(pictures >= 1, "at least one picture");
  const PictureScene scene(map, joint, evidence.noise, rig.cameras.at(static_cast<std::size_t>(camera)));
  const PictureEquations picture = picture_equations(scene, T_map_camera);
  const JointCovariance after =
      picture.tags.size() < 2 ? joint : JointUpdate(joint, picture, pictures).updated();
  std::vector<Matrix6d> covariances;
  for (Eigen::Index row = 0; row < after.by_noise.rows(); row += 6)
    covariances.push_back(after.block(row, row));
  return covariances;
}

}  // namespace apriltrack
