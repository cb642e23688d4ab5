#pragma once

#include <Eigen/Core>
#include <vector>

#include "apriltrack/calib/joint_covariance.h"
#include "apriltrack/calib/map_assessment.h"
#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// What a picture would say of the tags that it shows, its own pose eliminated: G xi + E e + noise, with xi
/// their right perturbations and e the errors that they keep.
struct PictureEquations {
  std::vector<Eigen::Index> tags;  ///< Into JointCovariance::tags, sorted.
  Eigen::MatrixXd G;               ///< (8k - 6) x 6k
  Eigen::MatrixXd E;               ///< (8k - 6) x 8k, for errors of unit variance.
};

/// A camera, and the tags of a joint covariance that it may see.
struct PictureScene {
  std::vector<MapTag> tags;  ///< In the order of JointCovariance::tags.
  CornerNoise noise;
  CameraModel lens;
  int width = 0, height = 0;
  /// Of more, those nearest to the picture's centre are taken, beside those that it was made for.
  std::size_t most_tags = 1000;
  bool are_errors_of_corners = false;  ///< That tags keep (JointCovariance).

  PictureScene(const TagMap& map, const JointCovariance& joint, const CornerNoise& noise,
               const Camera& camera);
};

/// tags.size() < 2 where it shows too few: seen whole, from at most 65 degrees aside, large enough to be
/// read. made_for: places of tags that are to be among them.
PictureEquations picture_equations(const PictureScene& scene, const Pose& T_map_camera,
                                   const std::vector<Eigen::Index>& made_for = {});

/// A covariance with the picture's equations taken into account `pictures` times over: of what is left of the
/// noise, and of how poses follow the errors that tags keep, which do not average.
class JointUpdate {
 public:
  JointUpdate(const JointCovariance& joint, const PictureEquations& picture, int pictures);

  /// Of the tag at that place of joint.tags.
  Matrix6d covariance_of(Eigen::Index tag) const;
  JointCovariance updated() const;

 private:
  /// Less what the pictures' own errors of that kind put in.
  void correct(const Eigen::MatrixXd& gain, Eigen::MatrixXd& by_errors) const;

  const JointCovariance& joint_;
  std::vector<Eigen::Index> rows_;  ///< Of the visible tags in the joint matrix.
  Eigen::MatrixXd G_;
  Eigen::MatrixXd E_;                  ///< In units of what tags keep.
  std::vector<Eigen::Index> columns_;  ///< Of the visible tags in by_errors.
  Eigen::MatrixXd projector_;          ///< G' M^-1.
};

}  // namespace apriltrack
