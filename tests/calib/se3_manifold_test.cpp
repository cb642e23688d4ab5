#include "numerics/se3_manifold.h"

#include <ceres/manifold_test_utils.h>

#include "apriltrack/base/random.h"
#include "support/numeric_jacobian.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

Vector6d random_twist(RandomStream& random, double max_angle_rad) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = random.normal();
  xi.tail<3>() *= max_angle_rad * random.uniform() / xi.tail<3>().norm();
  return xi;
}

TEST(Se3Manifold, KeepsCeresInvariants) {
  RandomStream random(1);
  const Se3Manifold manifold;
  for (int i = 0; i < 50; ++i) {
    const PoseBlock a = to_block(Pose::exp(random_twist(random, 3.1)));
    const Vector6d xi = random_twist(random, i % 5 == 0 ? 1e-9 : 3.0);
    const ceres::Vector x = Eigen::Map<const Eigen::Matrix<double, 7, 1>>(a.data());
    const ceres::Vector delta = xi;
    EXPECT_THAT(manifold, ceres::XPlusZeroIsXAt(x, 1e-12));
    EXPECT_THAT(manifold, ceres::XMinusXIsZeroAt(x, 1e-12));
    EXPECT_THAT(manifold, ceres::MinusPlusIsIdentityAt(x, delta, 1e-8));
    EXPECT_THAT(manifold, ceres::MinusPlusJacobianIsIdentityAt(x, 1e-12));
    EXPECT_THAT(manifold, ceres::HasCorrectPlusJacobianAt(x, 1e-8));
    EXPECT_THAT(manifold, ceres::HasCorrectMinusJacobianAt(x, 1e-8));
  }
}

TEST(Se3Manifold, PerturbsOnTheRightByTheWholeAngle) {
  const Pose T(Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ())),
               {1.0, 2.0, 3.0});
  Vector6d xi;
  xi << 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  const PoseBlock before = to_block(T);
  PoseBlock after;
  Se3Manifold().Plus(before.data(), xi.data(), after.data());
  EXPECT_NEAR(after[4], 1.0, 1e-15);  // x of the body is y of the world
  EXPECT_NEAR(after[5], 3.0, 1e-15);

  xi << 0.0, 0.0, 0.0, 0.2, 0.0, 0.0;
  Se3Manifold().Plus(before.data(), xi.data(), after.data());
  EXPECT_NEAR(rotation_angle_rad(T.rotation(), from_block(after.data()).rotation()), 0.2, 1e-12);
}

}  // namespace
}  // namespace apriltrack
