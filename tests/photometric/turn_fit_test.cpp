#include "turn_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

/// Hills of light in directions of the world, as a camera turned by R_world_camera sees them.
Image<float> hills(const Eigen::Quaterniond& R_world_camera, float focal_px) {
  Image<float> picture(80, 60);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Eigen::Vector3d ray((x - 39.5) / static_cast<double>(focal_px),
                                (y - 29.5) / static_cast<double>(focal_px), 1.0);
      const Eigen::Vector3d at = R_world_camera * ray.normalized();
      picture(x, y) =
          static_cast<float>(0.5 + 0.2 * std::sin(9.0 * at.x() + 1.0) * std::cos(7.0 * at.y() - 0.5) +
                             0.1 * std::sin(13.0 * at.y() + 5.0 * at.z()));
    }
  }
  return picture;
}

TEST(TurnFit, FindsTheTurnFromNearby) {
  constexpr float kFocal_px = 70.0F;
  const Image<float> before = hills(Eigen::Quaterniond::Identity(), kFocal_px);
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d(0.05, 0.0, 0.0), Eigen::Vector3d(0.0, -0.06, 0.0),
                                      Eigen::Vector3d(0.0, 0.0, 0.08), Eigen::Vector3d(0.1, 0.1, -0.05)}) {
    const Image<float> now = hills(rotation_exp(turn), kFocal_px);
    const FittedTurn fit = fit_turn({before, now, kFocal_px}, Eigen::Quaterniond::Identity());
    EXPECT_LT((rotation_log(fit.R_before_now) - turn).norm(), 0.001) << turn.transpose();
    EXPECT_GT(fit.correlation, 0.99);
    EXPECT_GT(fit.common_share, 0.7);
    EXPECT_LT(fit.common_share, 1.0);
  }
}

TEST(TurnFit, StartsFromAnyRoll) {
  // Its steps are about axes of the camera now, which are not those of the camera before.
  constexpr float kFocal_px = 70.0F;
  const Image<float> before = hills(Eigen::Quaterniond::Identity(), kFocal_px);
  for (const double roll : {-2.0, 1.5, 3.0}) {
    const Eigen::Quaterniond start = rotation_exp({0.0, 0.0, roll});
    const Eigen::Quaterniond truth = start * rotation_exp({0.04, -0.05, 0.03});
    const FittedTurn fit = fit_turn({before, hills(truth, kFocal_px), kFocal_px}, start);
    EXPECT_LT(rotation_log(fit.R_before_now.conjugate() * truth).norm(), 0.001) << roll;
  }
}

TEST(TurnFit, LikensNoNegative) {
  constexpr float kFocal_px = 70.0F;
  const Image<float> before = hills(Eigen::Quaterniond::Identity(), kFocal_px);
  Image<float> now(before.width(), before.height());
  for (int y = 0; y < now.height(); ++y) {
    for (int x = 0; x < now.width(); ++x) now(x, y) = 1.0F - before(x, y);
  }
  EXPECT_LE(fit_turn({before, now, kFocal_px}, Eigen::Quaterniond::Identity()).correlation, 0.0);
}

TEST(TurnFit, StaysWherePicturesAreTheSame) {
  // To the last bit: what a camera at rest shows in a simulation, and a frame that is delivered twice. With a
  // focal length that divides without rounding, nothing at all is left over.
  constexpr float kFocal_px = 64.0F;
  const Image<float> picture = hills(Eigen::Quaterniond::Identity(), kFocal_px);
  const FittedTurn fit = fit_turn({picture, picture, kFocal_px}, Eigen::Quaterniond::Identity());
  EXPECT_LT(rotation_log(fit.R_before_now).norm(), 1e-4);
  EXPECT_GT(fit.correlation, 0.999);
  EXPECT_GT(fit.common_share, 0.9);
}

TEST(TurnFit, TellsNothingWhereNothingIsInCommon) {
  constexpr float kFocal_px = 70.0F;
  const Image<float> picture = hills(Eigen::Quaterniond::Identity(), kFocal_px);
  for (const double angle : {1.4, 3.0}) {
    const FittedTurn fit = fit_turn({picture, picture, kFocal_px}, rotation_exp({0.0, angle, 0.0}));
    EXPECT_EQ(fit.common_share, 0.0) << angle;
    EXPECT_EQ(fit.correlation, 0.0) << angle;
  }
}

}  // namespace
}  // namespace apriltrack
