#include "apriltrack/geometry/tag_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "apriltrack/geometry/rotation.h"

namespace apriltrack {
namespace {

TEST(TagViewCosine, IsThatOfTheAngleToTheLineOfSight) {
  for (const double angle_rad : {0.0, 0.4, 1.3, 1.7, 3.0}) {
    for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.6, -0.8, 0)}) {
      const Pose turned(rotation_exp(angle_rad * axis), {0.0, 0.0, 0.7});
      EXPECT_NEAR(tag_view_cosine(turned), std::cos(angle_rad), 1e-12);
      // Seen off the axis, by a camera that has turned about its own centre: the same angle.
      const Pose aside = Pose(rotation_exp({0.3, 0.5, -0.2}), Eigen::Vector3d::Zero()) * turned;
      EXPECT_NEAR(tag_view_cosine(aside), std::cos(angle_rad), 1e-12);
    }
  }
  // Parallel to the image, but far to the side.
  EXPECT_NEAR(tag_view_cosine(Pose(Eigen::Quaterniond::Identity(), {3.0, 0.0, 4.0})), 0.8, 1e-12);
}

}  // namespace
}  // namespace apriltrack
