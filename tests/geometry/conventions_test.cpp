// The project's conventions on an example that can be checked by hand (docs/conventions.md).

#include <gmock/gmock.h>

#include <array>
#include <numbers>

#include "apriltrack/geometry/planar_pnp.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/geometry/rotation.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::PoseNear;

// A camera 1.5 m above a floor (world: x east, y north, z up) at (1, 2), that looks north: its x points east,
// its y down, its z north.
Pose T_world_camera() {
  Eigen::Matrix3d R_world_camera;
  R_world_camera.col(0) = Eigen::Vector3d(1, 0, 0);
  R_world_camera.col(1) = Eigen::Vector3d(0, 0, -1);
  R_world_camera.col(2) = Eigen::Vector3d(0, 1, 0);
  return {R_world_camera, Eigen::Vector3d(1.0, 2.0, 1.5)};
}

// An upright tag on a wall 4 m north of the origin, faced by the camera: x to the reader's right (east), y
// down, z INTO the wall (north).
Pose T_world_tag() {
  return {T_world_camera().rotation(), Eigen::Vector3d(1.0, 4.0, 1.5)};
}

TEST(Conventions, NeighbouringNamesCancel) {
  const Pose T_camera_tag = T_world_camera().inverse() * T_world_tag();
  EXPECT_THAT(T_camera_tag, PoseNear(Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 2.0}), 1e-15, 1e-15));
  const Eigen::Vector3d corner_tag(-0.1, 0.1, 0.0);
  EXPECT_LT((T_world_camera() * (T_camera_tag * corner_tag) - T_world_tag() * corner_tag).norm(), 1e-15);
}

TEST(Conventions, AnUprightTagBeforeTheCameraHasIdentityOrientation) {
  // Frontal, 2 m ahead, 0.2 m wide: bottom-left, bottom-right, top-right, top-left as the image shows them, y
  // down.
  const std::array<Eigen::Vector2d, 4> corners = {
      Eigen::Vector2d(-0.05, 0.05), {0.05, 0.05}, {0.05, -0.05}, {-0.05, -0.05}};
  std::array<Eigen::Vector3d, 4> rays;
  for (std::size_t i = 0; i < 4; ++i) rays[i] = corners[i].homogeneous().normalized();
  const PlanarPoses poses = solve_planar_pnp(rays, 0.2);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_THAT(poses[0].T_camera_tag,
              PoseNear(Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 2.0}), 1e-9, 1e-6));
}

TEST(Conventions, TheFirstCornerOfAnUprightTagIsItsBottomLeft) {
  const Eigen::Vector3d corner_world = T_world_tag() * Eigen::Vector3d(-0.1, 0.1, 0.0);
  EXPECT_LT((corner_world - Eigen::Vector3d(0.9, 4.0, 1.4)).norm(), 1e-15)
      << "west of the centre, and below it";
}

TEST(Conventions, ATagTurnedClockwiseIsTurnedAboutItsZ) {
  // A quarter turn clockwise, as the reader sees it: the bottom-left corner goes to the top left.
  const Pose turned =
      T_world_tag() * Pose(rotation_exp({0.0, 0.0, std::numbers::pi / 2}), Eigen::Vector3d::Zero());
  const Eigen::Vector3d first_corner_world = turned * Eigen::Vector3d(-0.1, 0.1, 0.0);
  EXPECT_LT((first_corner_world - Eigen::Vector3d(0.9, 4.0, 1.6)).norm(), 1e-15);
}

TEST(Conventions, PerturbationsAreFeltInTheFrameOnTheRight) {
  // A right perturbation of T_world_camera along z moves the camera forward: north.
  Vector6d xi = Vector6d::Zero();
  xi(2) = 0.25;
  EXPECT_LT(((T_world_camera() * Pose::exp(xi)).translation() - Eigen::Vector3d(1.0, 2.25, 1.5)).norm(),
            1e-15);
  // And about its y (down), to the right: from north to east.
  xi.setZero();
  xi(4) = std::numbers::pi / 2;
  const Eigen::Vector3d looks = (T_world_camera() * Pose::exp(xi)).rotation() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((looks - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace apriltrack
