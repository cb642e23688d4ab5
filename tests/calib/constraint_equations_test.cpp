#include "constraints/constraint_equations.h"

#include <gtest/gtest.h>

#include <numbers>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "support/numeric_jacobian.h"

namespace apriltrack {
namespace {

constexpr int kTagsDrawn = 4;

Pose drawn_pose(RandomStream& random, double turn_rad) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = random.normal() * (i < 3 ? 1.0 : turn_rad);
  return Pose::exp(xi);
}

ConstraintState drawn_state(std::uint64_t trial) {
  RandomStream random(301, trial);
  ConstraintState state;
  for (int i = 0; i < kTagsDrawn; ++i) state.T_held_tag.push_back(drawn_pose(random, 0.8));
  state.T_map_held = drawn_pose(random, 0.8);
  state.T_held_plane.push_back(drawn_pose(random, 0.8));
  return state;
}

TagKey key(int id) {
  return {"tag36h11", id};
}

std::vector<MapConstraint> one_of_each() {
  return {
      {.what = PositionConstraint{key(0), {1.0, std::nullopt, -0.5}, 0.01}},
      {.what = DistanceConstraint{key(0), key(2), 1.5, 0.002}},
      {.what = RelativePoseConstraint{key(0), key(1), {0.1, 0.2, -0.3}, std::nullopt, 0.01, std::nullopt}},
      {.what =
           RelativePoseConstraint{
               key(2), key(1), {0.1, 0.2, -0.3}, rotation_exp({0.3, -0.2, 0.5}), 0.01, 0.02}},
      {.what = CoplanarConstraint{{key(0), key(1), key(2), key(3)}, 0.01, 0.02}},
      {.what = CoplanarConstraint{{key(0), key(1), key(2), key(3)}, 0.01, std::nullopt}},
      {.what = UprightConstraint{key(3), 0.01}},
      {.what = FloorConstraint{key(1), 0.01, 0.02}},
      {.what = FloorConstraint{key(1), 0.01, std::nullopt}},
      {.what = GravityConstraint{key(2), {0.3, -2.0, 0.4}, 0.01}},
  };
}

BoundConstraint bind(const MapConstraint& constraint) {
  BoundConstraint bound{.constraint = &constraint, .index = 0, .tags = {}, .plane = -1};
  for (const TagKey& tag : tags_of(constraint)) bound.tags.push_back(tag.id);
  if (std::holds_alternative<CoplanarConstraint>(constraint.what)) bound.plane = 0;
  return bound;
}

TEST(ConstraintEquations, JacobiansAgreeWithDifferences) {
  const std::vector<MapConstraint> constraints = one_of_each();
  int checked = 0;
  for (std::uint64_t trial = 0; trial < 5; ++trial) {
    const ConstraintState state = drawn_state(trial);
    for (const MapConstraint& constraint : constraints) {
      SCOPED_TRACE(title_of(constraint));
      const BoundConstraint bound = bind(constraint);
      const LinearConstraint linear = linearise(bound, state);
      ASSERT_EQ(linear.residual.size(), static_cast<Eigen::Index>(linear.rows.size()));
      for (std::size_t t = 0; t < bound.tags.size(); ++t) {
        const auto residual = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
          ConstraintState moved = state;
          Pose& pose = moved.T_held_tag[static_cast<std::size_t>(bound.tags[t])];
          pose = pose * Pose::exp(Vector6d(xi));
          return linearise(bound, moved).residual;
        };
        EXPECT_TRUE(test::jacobians_agree(linear.by_tag[t], test::numeric_jacobian(residual, 6), 1e-6));
        ++checked;
      }
      const auto by_frame = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        ConstraintState moved = state;
        moved.T_map_held = moved.T_map_held * Pose::exp(Vector6d(xi));
        return linearise(bound, moved).residual;
      };
      EXPECT_TRUE(test::jacobians_agree(linear.by_frame, test::numeric_jacobian(by_frame, 6), 1e-6));
      EXPECT_EQ(linear.by_frame.isZero(0.0), !is_of_frame(constraint));
      if (bound.plane < 0) continue;
      const auto by_plane = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
        ConstraintState moved = state;
        moved.T_held_plane[0] = moved_plane(moved.T_held_plane[0], Eigen::Vector3d(step));
        return linearise(bound, moved).residual;
      };
      EXPECT_TRUE(
          test::jacobians_agree(linear.by_plane, test::numeric_jacobian(by_plane, kPlaneUnknowns), 1e-6));
      ++checked;
    }
  }
  EXPECT_EQ(checked, 5 * (1 + 2 + 2 + 2 + 5 + 5 + 1 + 1 + 1 + 1));
}

// From what the words mean, in places that are drawn.
TEST(ConstraintEquations, ResidualsAreWhatWasMeasuredWrong) {
  const ConstraintState state = drawn_state(9);
  const Pose T_map_tag = state.T_map_held * state.T_held_tag[1];
  const Eigen::Vector3d centre = T_map_tag.translation();

  const MapConstraint position{
      .what = PositionConstraint{key(1), {centre.x() - 0.03, std::nullopt, centre.z() + 0.02}, 0.01}};
  const Eigen::VectorXd of_position = linearise(bind(position), state).residual;
  ASSERT_EQ(of_position.size(), 2);
  EXPECT_NEAR(of_position[0], 3.0, 1e-9);
  EXPECT_NEAR(of_position[1], -2.0, 1e-9);

  const double distance_m = (state.T_held_tag[0].translation() - state.T_held_tag[1].translation()).norm();
  const MapConstraint distance{.what = DistanceConstraint{key(0), key(1), distance_m - 0.004, 0.002}};
  EXPECT_NEAR(linearise(bind(distance), state).residual[0], 2.0, 1e-9);

  const Eigen::Vector3d down_tag = T_map_tag.rotation().conjugate() * Eigen::Vector3d(0.0, 0.0, -3.0);
  const MapConstraint gravity{.what = GravityConstraint{key(1), down_tag, 0.01}};
  EXPECT_LT(linearise(bind(gravity), state).residual.norm(), 1e-9);

  const Pose T_ab = state.T_held_tag[0].inverse() * state.T_held_tag[1];
  const Pose measured = T_ab * Pose(rotation_exp({0.0, 0.04, 0.0}), Eigen::Vector3d::Zero());
  const MapConstraint board{.what = RelativePoseConstraint{key(0), key(1), measured.translation(),
                                                           measured.rotation(), 0.01, 0.02}};
  Vector6d expected = Vector6d::Zero();
  expected[4] = -2.0;
  EXPECT_LT((linearise(bind(board), state).residual - expected).norm(), 1e-9);
}

TEST(ConstraintEquations, ADirectionThatPointsTheWrongWayIsHalfATurnOff) {
  // A sine would call a tag that hangs upside down upright.
  EXPECT_NEAR(direction_error(Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ(), nullptr).norm(),
              std::numbers::pi, 1e-12);
  const Eigen::Vector3d nearly = Eigen::Vector3d(1e-3, 0.0, 1.0).normalized();
  EXPECT_NEAR(direction_error(nearly, -Eigen::Vector3d::UnitZ(), nullptr).norm(),
              std::numbers::pi - std::atan(1e-3), 1e-9);
}

TEST(ConstraintEquations, FacesUpOnTheFloorAndDownWhenHungUpright) {
  ConstraintState state;
  // x right, y down, z into the tag: on the floor z is down.
  state.T_held_tag = {Pose(rotation_exp({std::numbers::pi, 0.0, 0.0}), {1.0, 2.0, 0.0}),
                      Pose(rotation_exp({-std::numbers::pi / 2, 0.0, 0.0}), {0.0, 0.0, 1.0})};
  EXPECT_LT((state.T_held_tag[1].rotation() * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
  const MapConstraint floor{.what = FloorConstraint{key(0), 0.001, 0.01}};
  const MapConstraint upright{.what = UprightConstraint{key(1), 0.01}};
  EXPECT_LT(linearise(bind(floor), state).residual.norm(), 1e-9);
  EXPECT_LT(linearise(bind(upright), state).residual.norm(), 1e-9);
}

}  // namespace
}  // namespace apriltrack
