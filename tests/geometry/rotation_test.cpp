#include "apriltrack/geometry/rotation.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "apriltrack/base/random.h"
#include "support/numeric_jacobian.h"

namespace apriltrack {
namespace {

Eigen::Vector3d random_direction(RandomStream& random) {
  return Eigen::Vector3d{random.normal(), random.normal(), random.normal()}.normalized();
}

/// Angles at which series take over from closed forms, and both ends of the logarithm's range.
std::vector<double> angles_of_interest() {
  return {0.0,
          1e-300,
          1e-12,
          1e-8,
          0.99e-4,
          1.01e-4,
          1e-3,
          0.1,
          1.0,
          2.0,
          3.0,
          3.1,
          3.14,
          std::numbers::pi - 1e-6,
          std::numbers::pi - 1e-9,
          std::numbers::pi - 1e-12};
}

/// The exponential by its power series: an independent truth for exp of any matrix of modest size.
Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& generator) {
  Eigen::MatrixXd term = Eigen::MatrixXd::Identity(generator.rows(), generator.cols());
  Eigen::MatrixXd sum = term;
  for (int n = 1; n < 60; ++n) {
    term = term * generator / n;
    sum += term;
  }
  return sum;
}

TEST(Rotation, SkewIsTheCrossProduct) {
  RandomStream random(201);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d a = random_direction(random);
    const Eigen::Vector3d b = random_direction(random);
    EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
  }
}

TEST(Rotation, ExpIsTheMatrixExponential) {
  RandomStream random(202);
  for (const double angle : angles_of_interest()) {
    const Eigen::Vector3d w = angle * random_direction(random);
    EXPECT_LT((rotation_exp(w).toRotationMatrix() - matrix_exponential(skew(w))).norm(), 1e-14) << angle;
  }
}

TEST(Rotation, LogInvertsExpOverItsWholeRange) {
  RandomStream random(203);
  for (const double angle : angles_of_interest()) {
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector3d w = angle * random_direction(random);
      EXPECT_LT((rotation_log(rotation_exp(w)) - w).norm(), 1e-14 + 1e-15 * angle) << angle;
    }
  }
}

TEST(Rotation, LogIsTheSameForBothSignsOfTheQuaternion) {
  RandomStream random(204);
  for (const double angle : angles_of_interest()) {
    const Eigen::Quaterniond q = rotation_exp(angle * random_direction(random));
    const Eigen::Quaterniond minus_q(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_LT((rotation_log(q) - rotation_log(minus_q)).norm(), 1e-14) << angle;
  }
}

TEST(Rotation, HalfATurnHasALogOfLengthPi) {
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Quaterniond q(0.0, 0.0, 0.0, 0.0);
    q.vec() = Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d w = rotation_log(q);
    EXPECT_NEAR(w.norm(), std::numbers::pi, 1e-15);
    EXPECT_LT((rotation_exp(w).toRotationMatrix() - q.toRotationMatrix()).norm(), 1e-15);
  }
}

TEST(Rotation, AnglesBeyondHalfATurnComeBackTheShortWay) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, -2.0) / 3.0;
  const Eigen::Vector3d w = rotation_log(rotation_exp((std::numbers::pi + 0.5) * axis));
  EXPECT_LT((w + (std::numbers::pi - 0.5) * axis).norm(), 1e-14);
}

TEST(Rotation, LeftJacobianIsTheDerivativeOfExp) {
  RandomStream random(205);
  int num_checked = 0;
  for (const double angle : angles_of_interest()) {
    const Eigen::Vector3d w = angle * random_direction(random);
    const Eigen::Quaterniond exp_w = rotation_exp(w);
    const auto moved = [&](const Eigen::VectorXd& dw) {
      const Eigen::Vector3d sum = w + Eigen::Vector3d(dw);
      return Eigen::VectorXd(rotation_log(rotation_exp(sum) * exp_w.conjugate()));
    };
    EXPECT_TRUE(test::jacobians_agree(rotation_left_jacobian(w), test::numeric_jacobian(moved, 3), 1e-8))
        << angle;
    ++num_checked;
  }
  EXPECT_EQ(num_checked, 16);
}

TEST(Rotation, LeftJacobianInverseIsItsInverse) {
  RandomStream random(206);
  for (const double angle : angles_of_interest()) {
    const Eigen::Vector3d w = angle * random_direction(random);
    const Eigen::Matrix3d product = rotation_left_jacobian(w) * rotation_left_jacobian_inverse(w);
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 1e-12) << angle;
  }
}

// Three turns about standing axes, x first, written out.
TEST(Rotation, RollPitchYawTurnAboutStandingAxes) {
  const double r = 0.3, p = -0.7, y = 2.1;
  Eigen::Matrix3d about_x, about_y, about_z;
  about_x << 1, 0, 0, 0, std::cos(r), -std::sin(r), 0, std::sin(r), std::cos(r);
  about_y << std::cos(p), 0, std::sin(p), 0, 1, 0, -std::sin(p), 0, std::cos(p);
  about_z << std::cos(y), -std::sin(y), 0, std::sin(y), std::cos(y), 0, 0, 0, 1;
  const Eigen::Quaterniond rotation = rotation_of_roll_pitch_yaw({r, p, y});
  EXPECT_LT((rotation.toRotationMatrix() - about_z * about_y * about_x).norm(), 1e-15);
  EXPECT_LT((roll_pitch_yaw_of(rotation) - Eigen::Vector3d(r, p, y)).norm(), 1e-14);
}

TEST(Rotation, RollPitchYawGiveTheRotationAtThePoles) {
  RandomStream random(209);
  int poles = 0;
  for (const double pitch : {0.5 * std::numbers::pi, -0.5 * std::numbers::pi}) {
    for (const double off : {0.0, 1e-16, 1e-12, 1e-9, 1e-8, 1e-6}) {
      for (int i = 0; i < 20; ++i, ++poles) {
        const Eigen::Quaterniond rotation = rotation_of_roll_pitch_yaw(
            {random.uniform(-3.0, 3.0), pitch - std::copysign(off, pitch), random.uniform(-3.0, 3.0)});
        const Eigen::Vector3d angles = roll_pitch_yaw_of(rotation);
        EXPECT_LT(rotation_log(rotation.conjugate() * rotation_of_roll_pitch_yaw(angles)).norm(), 1e-14);
        EXPECT_LE(std::abs(angles.y()), 0.5 * std::numbers::pi);
      }
    }
  }
  EXPECT_EQ(poles, 240);
}

// A = R S with S symmetric and positive definite has R for its nearest rotation (polar decomposition).
TEST(NearestRotation, IsTheTurnOfAStretchedOne) {
  RandomStream random(231);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d R =
        rotation_exp(3.0 * random.uniform() * random_direction(random)).toRotationMatrix();
    const Eigen::Matrix3d turn = rotation_exp(random_direction(random)).toRotationMatrix();
    const Eigen::Vector3d stretch{0.5 + random.uniform(), 0.5 + random.uniform(), 0.5 + random.uniform()};
    const Eigen::Matrix3d S = turn * stretch.asDiagonal() * turn.transpose();
    EXPECT_NEAR((nearest_rotation(R * S) - R).norm(), 0.0, 1e-13);
  }
}

// Of a mirror image it is the best of all rotations: none of many others is nearer.
TEST(NearestRotation, IsNeverAMirrorImage) {
  RandomStream random(232);
  const Eigen::Matrix3d turn = rotation_exp(random_direction(random)).toRotationMatrix();
  const Eigen::Matrix3d mirrored = turn * Eigen::Vector3d(1.0, 0.9, -0.3).asDiagonal();
  const Eigen::Matrix3d nearest = nearest_rotation(mirrored);
  EXPECT_NEAR(nearest.determinant(), 1.0, 1e-14);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3d other =
        rotation_exp(3.1 * random.uniform() * random_direction(random)).toRotationMatrix();
    EXPECT_LE((nearest - mirrored).norm(), (other - mirrored).norm());
  }
}

}  // namespace
}  // namespace apriltrack
