#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// Two small pictures of one camera that has only turned between them, without distortion: NaN where they
/// show nothing.
struct TurnedPictures {
  const Image<float>& before;
  const Image<float>& now;
  float focal_px;
};

struct FittedTurn {
  Eigen::Quaterniond R_before_now = Eigen::Quaterniond::Identity();
  double sigma_rad = 0.0;     ///< Of the worst axis, were pixels independent.
  double common_share = 0.0;  ///< Of the pixels of `now`, those that `before` shows.
  double correlation = 0.0;   ///< Over these, where `now` is no negative of `before`.
};

/// Gauss and Newton's steps to the turn, with a gain and an offset of the light, that makes the one picture
/// of the other; what does not fit counts less.
FittedTurn fit_turn(const TurnedPictures& pictures, const Eigen::Quaterniond& start);

}  // namespace apriltrack
