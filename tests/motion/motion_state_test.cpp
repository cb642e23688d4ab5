#include "apriltrack/motion/motion_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "apriltrack/base/check.h"
#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/motion/track_mode.h"
#include "support/numeric_jacobian.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {
using test::jacobians_agree;
using test::numeric_jacobian;
using test::PoseNear;

constexpr double kRounding = 1e-12;

Vector6d random_vector(RandomStream& random, double scale) {
  Vector6d v;
  for (double& value : v) value = scale * random.uniform(-1.0, 1.0);
  return v;
}

/// Fast: some 3 m/s and 10 rad/s.
MotionState random_state(RandomStream& random) {
  MotionState state;
  state.pose = Pose::exp(random_vector(random, 1.5));
  state.velocity << 3.0 * random_vector(random, 1.0).head<3>(), 10.0 * random_vector(random, 1.0).head<3>();
  return state;
}

Matrix12d random_covariance(RandomStream& random) {
  Matrix12d root;
  for (double& value : root.reshaped()) value = random.uniform(-1.0, 1.0);
  return root * root.transpose();
}

TEST(MotionState, StepsAndDifferencesAreInverse) {
  RandomStream random(1);
  for (int i = 0; i < 20; ++i) {
    const MotionState from = random_state(random), to = random_state(random);
    const MotionState there = moved(from, difference(from, to));
    EXPECT_THAT(there.pose, PoseNear(to.pose, kRounding, 1e-7));  // the angle of a quaternion near 1
    EXPECT_NEAR((there.velocity - to.velocity).norm(), 0.0, kRounding);
  }
}

TEST(MotionState, OriginMovesStraightWhileItTurns) {
  MotionState state;
  state.pose = {rotation_exp({0.0, 0.0, 0.5 * std::numbers::pi}), {1.0, 2.0, 3.0}};
  state.velocity << 2.0, 0.0, 0.0, 0.0, 0.0, 4.0;
  // Its x is the left frame's y; a helix would have turned the path by 2 rad meanwhile.
  const Pose expected(rotation_exp({0.0, 0.0, 0.5 * std::numbers::pi + 2.0}), {1.0, 3.0, 3.0});
  EXPECT_THAT(pose_after(state, 0.5), PoseNear(expected, kRounding, 1e-7));
  EXPECT_THAT(predict(state, 0.5).pose, PoseNear(expected, kRounding, 1e-7));
}

TEST(MotionState, AccelerationBendsThePathAsAFallDoes) {
  MotionState state;
  state.velocity[0] = 3.0;
  state.velocity[5] = 1.0;
  state.acceleration[1] = -9.81;
  state.acceleration[5] = 6.0;
  for (const double t : {-0.2, 0.1, 0.4}) {
    const Pose expected(rotation_exp({0.0, 0.0, t + 3.0 * t * t}), {3.0 * t, -0.5 * 9.81 * t * t, 0.0});
    EXPECT_THAT(pose_after(state, t), PoseNear(expected, kRounding, 1e-7));
  }
}

TEST(MotionState, PredictionKeepsTheVelocityOfTheLeftFrame) {
  RandomStream random(2);
  for (int i = 0; i < 20; ++i) {
    const MotionState state = random_state(random);
    const MotionState next = predict(state, 0.1);
    const Eigen::Vector3d before = state.pose.rotation() * Eigen::Vector3d(state.velocity.head<3>());
    const Eigen::Vector3d after = next.pose.rotation() * Eigen::Vector3d(next.velocity.head<3>());
    EXPECT_NEAR((before - after).norm(), 0.0, kRounding);
    EXPECT_NEAR((next.velocity - state.velocity).tail<3>().norm(), 0.0, kRounding);
    // In two halves as in one.
    const MotionState halves = predict(predict(state, 0.06), 0.04);
    EXPECT_THAT(halves.pose, PoseNear(next.pose, kRounding, 1e-7));
    EXPECT_NEAR((halves.velocity - next.velocity).norm(), 0.0, kRounding);
  }
}

TEST(MotionBelief, CovarianceFollowsTheNumericJacobianOfThePrediction) {
  RandomStream random(3);
  const MotionNoise none{.linear_m2_per_s3 = 0.0, .angular_rad2_per_s3 = 0.0};
  for (const double dt_s : {0.0, 0.033, 0.3}) {
    MotionBelief belief{random_state(random), random_covariance(random)};
    const MotionState next = predict(belief.mean, dt_s);
    const Eigen::MatrixXd F = numeric_jacobian(
        [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
          return difference(next, predict(moved(belief.mean, Vector12d(step)), dt_s));
        },
        12);
    const Matrix12d expected = F * belief.covariance * F.transpose();
    EXPECT_TRUE(jacobians_agree(predict(belief, none, dt_s).covariance, expected, 1e-6)) << dt_s;
  }
}

TEST(MotionBelief, NoiseIsThatOfIntegratedWhiteAcceleration) {
  // Many kicks of one axis, integrated step by step, against the spread that the filter expects.
  constexpr double kDuration_s = 0.2, kDensity = 7.5;
  constexpr int kSteps = 50, kRuns = 20'000;
  constexpr double kStep_s = kDuration_s / kSteps;
  RandomStream random(4);
  double pp = 0.0, pv = 0.0, vv = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    double p = 0.0, v = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double kick = std::sqrt(kDensity * kStep_s) * random.normal();
      p += kStep_s * (v + 0.5 * kick);
      v += kick;
    }
    pp += p * p / kRuns;
    pv += p * v / kRuns;
    vv += v * v / kRuns;
  }
  const MotionNoise noise{.linear_m2_per_s3 = kDensity, .angular_rad2_per_s3 = 2.0 * kDensity};
  const Matrix12d found = predict(MotionBelief(), noise, kDuration_s).covariance;
  constexpr double kShare = 0.04;  // a variance of 20000 runs is known to 1 %
  for (int i = 0; i < 6; ++i) {
    const double factor = i < 3 ? 1.0 : 2.0;
    EXPECT_NEAR(found(i, i), factor * pp, kShare * factor * pp);
    EXPECT_NEAR(found(i, i + 6), factor * pv, kShare * factor * pv);
    EXPECT_NEAR(found(i + 6, i + 6), factor * vv, kShare * factor * vv);
  }
  EXPECT_EQ(found, found.transpose());
}

TEST(MotionBelief, ManySmallStepsSpreadAsOneLargeOne) {
  MotionBelief steps;  // at rest, so that no rotation couples the axes
  const MotionNoise noise;
  for (int i = 0; i < 10; ++i) steps = predict(steps, noise, 0.01);
  const Matrix12d one = predict(MotionBelief(), noise, 0.1).covariance;
  EXPECT_NEAR((steps.covariance - one).norm(), 0.0, 1e-9 * one.norm());
}

TEST(MotionBelief, RefusesTimeThatRunsBackwards) {
  EXPECT_THROW(predict(MotionBelief(), MotionNoise(), -0.01), MisuseError);
}

TEST(TrackMode, EgoPosesAreTheInverseOfTheView) {
  RandomStream random(5);
  const Pose pose = Pose::exp(random_vector(random, 1.0));
  const Eigen::Vector3d point(0.3, -0.2, 0.9);
  // T_world_camera takes what the view makes of a point of the map back to it; T_camera_body is the view.
  EXPECT_NEAR((pose * (camera_from_map(pose, TrackMode::kEgo) * point) - point).norm(), 0.0, kRounding);
  EXPECT_NEAR((camera_from_map(pose, TrackMode::kJoint) * point - pose * point).norm(), 0.0, kRounding);
  for (const TrackMode mode : {TrackMode::kEgo, TrackMode::kJoint})
    EXPECT_THAT(pose_from_camera(camera_from_map(pose, mode), mode), PoseNear(pose, kRounding, 1e-7));
}

TEST(MotionBelief, DistanceIsInStandardDeviations) {
  RandomStream random(8);
  MotionBelief belief;
  belief.mean.pose = Pose::exp(random_vector(random, 1.0));
  belief.mean.velocity = random_vector(random, 2.0);
  belief.covariance = random_covariance(random);
  const Matrix12d L = belief.covariance.llt().matrixL();
  const Matrix6d pose_L = Matrix6d(belief.covariance.topLeftCorner<6, 6>()).llt().matrixL();
  for (int run = 0; run < 10; ++run) {
    Vector12d z;  // a step of |z| standard deviations, by the covariance's root
    for (double& value : z) value = 0.02 * random.normal();
    EXPECT_NEAR(distance(belief, moved(belief.mean, L * z)), z.norm(), 1e-9);
    const Pose pose = belief.mean.pose * Pose::exp(pose_L * z.head<6>());
    EXPECT_NEAR(distance(belief, pose), z.head<6>().norm(), 1e-9);
  }
}

TEST(TrackMode, APerturbationOfThePoseIsOneOfTheViewOnItsLeft) {
  RandomStream random(6);
  for (int run = 0; run < 20; ++run) {
    const Pose pose = Pose::exp(random_vector(random, 1.5));
    const Vector6d xi = random_vector(random, 0.5);
    for (const TrackMode mode : {TrackMode::kEgo, TrackMode::kJoint}) {
      const Pose expected = camera_from_map(pose * Pose::exp(xi), mode);
      const Pose view = Pose::exp(view_by_pose(pose, mode) * xi) * camera_from_map(pose, mode);
      EXPECT_THAT(view, PoseNear(expected, kRounding, 1e-7));
    }
  }
}

TEST(TrackMode, CovariancesFollowThePose) {
  RandomStream random(7);
  const Matrix6d covariance = random_covariance(random).topLeftCorner<6, 6>();
  const Pose T_camera_map = Pose::exp(random_vector(random, 1.5));
  for (const TrackMode mode : {TrackMode::kEgo, TrackMode::kJoint}) {
    const Pose pose = pose_from_camera(T_camera_map, mode);
    const Matrix6d J = numeric_jacobian(
        [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
          return (pose.inverse() * pose_from_camera(T_camera_map * Pose::exp(xi), mode)).log();
        },
        6);
    EXPECT_TRUE(jacobians_agree(pose_covariance_from_camera(T_camera_map, covariance, mode),
                                J * covariance * J.transpose(), 1e-6));
  }
}

}  // namespace
}  // namespace apriltrack
