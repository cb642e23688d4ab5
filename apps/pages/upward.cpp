#include "upward.h"

#include <Eigen/Eigenvalues>

namespace apriltrack::app {

// Cameras look up and down more than they lean: what is at right angles to the pictures' right on the whole
// (Brown and Lowe, "Automatic panoramic image stitching", 2007). Where they did not turn much, what is up in
// the pictures; where they lay every way, what is up on the tags.
Eigen::Vector3d upward(const TagMap& map, const MapEvidence& evidence) {
  Eigen::Vector3d of_pictures = Eigen::Vector3d::Zero(), of_tags = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rights = Eigen::Matrix3d::Zero();
  for (const RigPose& moment : evidence.moments) {
    const Eigen::Matrix3d R = moment.T_map_rig.rotation_matrix();
    of_pictures -= R.col(1);
    rights += R.col(0) * R.col(0).transpose();
  }
  for (const MapTag& tag : map.tags) of_tags -= tag.T_map_tag.rotation() * Eigen::Vector3d::UnitY();
  const auto num = static_cast<double>(evidence.moments.size());
  if (of_pictures.norm() > 0.5 * num && num > 0.0) {
    constexpr double kTurned = 0.1;  // 18 degrees about the mean
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(rights / num);
    if (axes.eigenvalues()[1] < kTurned) return of_pictures.normalized();
    const Eigen::Vector3d level = axes.eigenvectors().col(0);
    return level.dot(of_pictures) > 0.0 ? level : Eigen::Vector3d(-level);
  }
  if (of_tags.norm() > 0.3 * static_cast<double>(map.tags.size())) return of_tags.normalized();
  return Eigen::Vector3d::UnitZ();
}

}  // namespace apriltrack::app
