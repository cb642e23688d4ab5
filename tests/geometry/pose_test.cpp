#include "apriltrack/geometry/pose.h"

#include <gmock/gmock.h>

#include <limits>
#include <numbers>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "support/numeric_jacobian.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using test::PoseNear;

constexpr double kPi = std::numbers::pi;
constexpr int kNumPoses = 100;

Vector6d random_twist(RandomStream& random, double max_angle_rad) {
  Vector6d xi;
  for (int i = 0; i < 3; ++i) xi(i) = random.uniform(-3.0, 3.0);
  const Eigen::Vector3d direction =
      Eigen::Vector3d{random.normal(), random.normal(), random.normal()}.normalized();
  xi.tail<3>() = random.uniform(0.0, max_angle_rad) * direction;
  return xi;
}

Pose random_pose(RandomStream& random) {
  const Vector6d xi = random_twist(random, kPi);
  return {rotation_exp(xi.tail<3>()), xi.head<3>()};
}

TEST(Pose, IsAGroup) {
  RandomStream random(211);
  for (int i = 0; i < kNumPoses; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    const Pose c = random_pose(random);
    EXPECT_THAT((a * b) * c, PoseNear(a * (b * c), 1e-13, 1e-13));
    EXPECT_THAT(a * Pose::identity(), PoseNear(a, 4e-15, 1e-15));  // some last digits of 3 m
    EXPECT_THAT(Pose::identity() * a, PoseNear(a, 4e-15, 1e-15));
    EXPECT_THAT(a * a.inverse(), PoseNear(Pose(), 1e-14, 1e-14));
    EXPECT_THAT(a.inverse() * a, PoseNear(Pose(), 1e-14, 1e-14));
  }
}

TEST(Pose, ActsOnPointsAsItsMatrix) {
  RandomStream random(212);
  for (int i = 0; i < kNumPoses; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    const Eigen::Vector3d point{random.normal(), random.normal(), random.normal()};
    EXPECT_LT((a * point - (a.matrix() * point.homogeneous()).head<3>()).norm(), 1e-14);
    EXPECT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), 1e-13);
    EXPECT_LT(((a * b) * point - a * (b * point)).norm(), 1e-13);
  }
}

TEST(Pose, ExpIsTheMatrixExponential) {
  RandomStream random(213);
  for (int i = 0; i < kNumPoses; ++i) {
    Vector6d xi = random_twist(random, kPi);
    if (i % 4 == 0) xi.tail<3>() *= 1e-7;
    Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
    generator.topLeftCorner<3, 3>() = skew(xi.tail<3>());
    generator.topRightCorner<3, 1>() = xi.head<3>();
    Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d sum = term;
    for (int n = 1; n < 60; ++n) {
      term = term * generator / n;
      sum += term;
    }
    EXPECT_LT((Pose::exp(xi).matrix() - sum).norm(), 1e-12);
  }
}

TEST(Pose, LogInvertsExp) {
  RandomStream random(214);
  for (const double scale : {1.0, 1e-3, 1e-4, 1e-6, 1e-12, 0.0}) {
    for (int i = 0; i < kNumPoses; ++i) {
      const Vector6d xi = scale * random_twist(random, kPi - 1e-9);
      EXPECT_LT((Pose::exp(xi).log() - xi).norm(), 1e-12) << scale;
    }
  }
}

TEST(Pose, ExpInvertsLogNearHalfATurn) {
  RandomStream random(215);
  for (const double short_of_pi : {1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
    for (int i = 0; i < 20; ++i) {
      Vector6d xi = random_twist(random, 1.0);
      xi.tail<3>() = (kPi - short_of_pi) * xi.tail<3>().normalized();
      const Pose pose(rotation_exp(xi.tail<3>()), xi.head<3>());
      EXPECT_THAT(Pose::exp(pose.log()), PoseNear(pose, 1e-12, 1e-12)) << short_of_pi;
    }
  }
}

TEST(Pose, AdjointMovesAPerturbationToTheOtherSide) {
  RandomStream random(216);
  for (int i = 0; i < kNumPoses; ++i) {
    const Pose T = random_pose(random);
    const Vector6d xi = random_twist(random, 2.0);
    EXPECT_THAT(T * Pose::exp(xi), PoseNear(Pose::exp(T.adjoint() * xi) * T, 1e-12, 1e-13));
  }
}

TEST(Pose, AdjointOfAProductIsTheProductOfAdjoints) {
  RandomStream random(217);
  for (int i = 0; i < kNumPoses; ++i) {
    const Pose a = random_pose(random);
    const Pose b = random_pose(random);
    EXPECT_LT(((a * b).adjoint() - a.adjoint() * b.adjoint()).norm(), 1e-12);
    EXPECT_LT((a.inverse().adjoint() * a.adjoint() - Matrix6d::Identity()).norm(), 1e-12);
  }
}

TEST(Pose, APointMovesWithTheRightPerturbationAsDocumented) {
  // d (T exp(xi) p) / d xi = R [I, -skew(p)]: what every Jacobian of the project is built on.
  RandomStream random(218);
  for (int i = 0; i < 20; ++i) {
    const Pose T = random_pose(random);
    const Eigen::Vector3d point{random.normal(), random.normal(), random.normal()};
    Eigen::Matrix<double, 3, 6> analytic;
    analytic << T.rotation_matrix(), -T.rotation_matrix() * skew(point);
    const auto moved = [&](const Eigen::VectorXd& xi) { return Eigen::VectorXd(T * Pose::exp(xi) * point); };
    EXPECT_TRUE(test::jacobians_agree(analytic, test::numeric_jacobian(moved, 6), 1e-8));
  }
}

TEST(Pose, InterpolateMeetsItsEndsAndKeepsItsTwist) {
  RandomStream random(219);
  for (int i = 0; i < kNumPoses; ++i) {
    const Pose a = random_pose(random);
    const Vector6d twist = random_twist(random, 3.0);
    const Pose b = a * Pose::exp(twist);
    EXPECT_THAT(interpolate(a, b, 0.0), PoseNear(a, 1e-13, 1e-13));
    EXPECT_THAT(interpolate(a, b, 1.0), PoseNear(b, 1e-12, 1e-12));
    for (const double fraction : {-0.5, 0.25, 0.5, 1.5}) {
      EXPECT_THAT(interpolate(a, b, fraction), PoseNear(a * Pose::exp(fraction * twist), 1e-11, 1e-12));
    }
    const Vector6d step = (interpolate(a, b, 0.3).inverse() * interpolate(a, b, 0.4)).log();
    EXPECT_LT((step - 0.1 * twist).norm(), 1e-11);
  }
}

TEST(Pose, RotationAngleIsTheAngleBetweenOrientations) {
  const Eigen::Quaterniond a = rotation_exp({0.3, -0.2, 0.5});
  EXPECT_NEAR(rotation_angle_rad(a, a * rotation_exp({0.0, 0.7, 0.0})), 0.7, 1e-14);
  EXPECT_NEAR(rotation_angle_rad(a, Eigen::Quaterniond(-a.w(), -a.x(), -a.y(), -a.z())), 0.0, 1e-14);
  EXPECT_NEAR(rotation_angle_rad(a, a * rotation_exp({0.0, 0.0, kPi})), kPi, 1e-14);
}

TEST(Pose, NormalisesItsQuaternionAndKeepsItsSign) {
  const Pose pose(Eigen::Quaterniond(-2.0, 0.0, 0.0, 2.0), Eigen::Vector3d::Zero());
  EXPECT_NEAR(pose.rotation().norm(), 1.0, 1e-15);
  EXPECT_NEAR(pose.rotation().w(), -std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(pose.rotation().z(), std::sqrt(0.5), 1e-15);
}

TEST(Pose, KnowsWhetherItIsFinite) {
  EXPECT_TRUE(Pose().is_finite());
  EXPECT_FALSE(
      Pose(Eigen::Quaterniond::Identity(), {0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}).is_finite());
  EXPECT_FALSE(Pose(Eigen::Quaterniond(0.0, 0.0, 0.0, std::numeric_limits<double>::infinity()),
                    Eigen::Vector3d::Zero())
                   .is_finite());
}

}  // namespace
}  // namespace apriltrack
