#include "seen_turn.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "support/numeric_jacobian.h"
#include "support/pose_matchers.h"

namespace apriltrack::test {
namespace {

using Eigen::Vector3d;
using Vector24d = Eigen::Matrix<double, 24, 1>;
using Matrix24d = Eigen::Matrix<double, 24, 24>;

constexpr MotionStep kStep{.noise = {}, .dt_s = 0.04, .speed_sigma = 0.0};

/// How a camera would have to turn that sees in direction `after` what was in direction `before`:
/// R_before_now.
Eigen::Quaterniond turn_between(const Vector3d& before, const Vector3d& after) {
  return Eigen::Quaterniond::FromTwoVectors(after, before);
}

/// [pose before; velocity before; accelerations' noise], all at once: the whole update, with nothing left
/// out.
struct WholeUpdate {
  WholeUpdate(const MotionBelief& before, const MotionStep& step, const SeenTurn& seen) {
    // What the noise alone adds, as an independent change of the state after the step.
    MotionBelief exact = before;
    exact.covariance.setZero();
    const MotionBelief noise = predicted(exact, step);
    const MotionState now = noise.mean;
    Matrix24d P = Matrix24d::Zero();
    P.topLeftCorner<12, 12>() = before.covariance;
    P.bottomRightCorner<12, 12>() = noise.covariance;
    const auto state_now = [&](const Eigen::VectorXd& x) {
      return moved(predict(moved(before.mean, Vector12d(x.head<12>())), step.dt_s), Vector12d(x.tail<12>()));
    };
    const auto shown = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      const Pose way = moved(before.mean, Vector12d(x.head<12>())).pose.inverse() * state_now(x).pose;
      const Vector3d by_way = seen.scene_camera.cross(way.translation()) / seen.scene_camera.squaredNorm();
      return rotation_log(way.rotation()) + by_way;
    };
    const Eigen::MatrixXd H = numeric_jacobian(shown, 24);
    const Eigen::MatrixXd G = numeric_jacobian(
        [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return difference(now, state_now(x)); }, 24);
    const Vector3d off = rotation_log(seen.turn.R_before_now) - Vector3d(shown(Vector24d::Zero()));
    // The scene may be nearer or farther than it is taken for, by 0.7 of what the way looks like.
    const Vector3d way =
        before.mean.pose.rotation().conjugate() * (now.pose.translation() - before.mean.pose.translation());
    const Vector3d by_depth = 0.7 * seen.scene_camera.cross(way) / seen.scene_camera.squaredNorm();
    const Eigen::Matrix3d S = H * P * H.transpose() + by_depth * by_depth.transpose() +
                              seen.turn.sigma_rad * seen.turn.sigma_rad * Eigen::Matrix3d::Identity();
    const Eigen::MatrixXd gain = P * H.transpose() * S.inverse();
    belief.mean = moved(now, G * gain * off);
    belief.covariance = G * (P - gain * H * P) * G.transpose();
    alone = {now, G * P * G.transpose()};
    log_density = -0.5 * (off.dot(S.inverse() * off) + std::log(S.determinant()));
    sigmas = std::sqrt(off.dot(S.inverse() * off));
  }
  MotionBelief belief, alone;
  double log_density = 0.0, sigmas = 0.0;
};

Vector3d random3(RandomStream& random, double scale) {
  return scale * Vector3d{random.normal(), random.normal(), random.normal()};
}

/// correlated: pose and velocity, as some frames without evidence leave them.
MotionBelief any_motion(RandomStream& random, bool is_correlated) {
  MotionBelief belief;
  belief.mean.pose = {rotation_exp(random3(random, 1.0)), random3(random, 1.0)};
  belief.mean.velocity << random3(random, 0.3), random3(random, 0.3);
  Vector12d sigmas;
  sigmas << Vector3d::Constant(0.01), Vector3d::Constant(0.01), Vector3d::Constant(0.4),
      Vector3d::Constant(2.0);
  Matrix12d root;
  for (double& value : root.reshaped()) value = random.uniform(-1.0, 1.0);
  if (!is_correlated) {
    root.topRightCorner<6, 6>().setZero();
    root.bottomLeftCorner<6, 6>().setZero();
  }
  root = sigmas.asDiagonal() * root;
  belief.covariance = root * root.transpose() / 4.0;
  return belief;
}

/// Of a turn as the motion expects it, and `off_rad` more.
SeenTurn any_turn(RandomStream& random, const MotionBelief& before, double off_rad) {
  const Pose way = before.mean.pose.inverse() * predict(before.mean, kStep.dt_s).pose;
  SeenTurn seen;
  seen.scene_camera = Vector3d(0.3, -0.2, 2.0) + random3(random, 0.2);
  seen.turn.R_before_now = way.rotation() * rotation_exp(random3(random, off_rad));
  seen.turn.sigma_rad = 0.02;
  return seen;
}

/// In units of what the first is uncertain by.
double sigmas_apart(const MotionBelief& belief, const MotionBelief& other) {
  return difference(belief.mean, other.mean).cwiseQuotient(belief.covariance.diagonal().cwiseSqrt()).norm();
}
Matrix12d in_sigmas(const Matrix12d& covariance, const Matrix12d& of) {
  const Vector12d scale = of.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

/// The logarithms of two turns of a degree differ by a little more than that of their difference.
constexpr double kLinearised = 0.05;

void expect_same_belief(const MotionBelief& belief, const MotionBelief& expected) {
  EXPECT_LT(sigmas_apart(expected, belief), kLinearised);
  const Matrix12d off =
      in_sigmas(belief.covariance, expected.covariance) - in_sigmas(expected.covariance, expected.covariance);
  EXPECT_LT(off.cwiseAbs().maxCoeff(), kLinearised);
}

TEST(SeenTurn, TellsOfTheMotionWhatBayesRuleDoes) {
  RandomStream random(1);
  for (int i = 0; i < 20; ++i) {
    const MotionBelief before = any_motion(random, false);
    const SeenTurn seen = any_turn(random, before, 0.02);
    const TurnedBelief turned = turned_by(before, kStep, seen);
    const WholeUpdate expected(before, kStep, seen);
    SCOPED_TRACE(i);
    ASSERT_LT(expected.sigmas, 4.5);
    expect_same_belief(turned.belief, expected.belief);
    // That it tells anything: of turning.
    const auto turning = [](const MotionBelief& of) { return of.covariance.diagonal().tail<3>().sum(); };
    EXPECT_LT(turning(turned.belief), 0.7 * turning(expected.alone));
    EXPECT_EQ(turned.velocity_before, predict(before.mean, kStep.dt_s).velocity);
  }
}

TEST(SeenTurn, TellsOfAPlaceThatIsTiedToTheVelocityWhatBayesRuleDoes) {
  // After frames without evidence, who went faster is farther.
  RandomStream random(2);
  for (int i = 0; i < 20; ++i) {
    const MotionBelief before = any_motion(random, true);
    const MotionStep step{.noise = {}, .dt_s = kStep.dt_s, .speed_sigma = i % 2 == 0 ? 0.0 : 0.3};
    const SeenTurn seen = any_turn(random, before, 0.02);
    const TurnedBelief turned = turned_by(before, step, seen);
    const WholeUpdate expected(before, step, seen);
    SCOPED_TRACE(i);
    ASSERT_LT(expected.sigmas, 4.5);
    expect_same_belief(turned.belief, expected.belief);
    const Matrix12d correlations = in_sigmas(turned.belief.covariance, turned.belief.covariance);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix12d>(correlations).eigenvalues().minCoeff(), 0.0) << i;
  }
}

TEST(SeenTurn, LeavesACovarianceThatIsOne) {
  // Frame after frame without evidence, as the tracker goes through them.
  MotionBelief belief;
  belief.mean.velocity << 0.5, 0.0, 0.0, 0.0, 3.0, 0.0;
  belief.covariance.diagonal() << Vector6d::Constant(1e-5), Vector3d::Constant(0.05), Vector3d::Constant(0.1);
  SeenTurn seen;
  seen.scene_camera = {0.0, 0.0, 2.0};
  seen.turn.sigma_rad = 0.02;
  for (int i = 0; i < 8; ++i) {
    seen.turn.R_before_now = rotation_exp(kStep.dt_s * belief.mean.velocity.tail<3>());
    belief = turned_by(belief, kStep, seen).belief;
    const Matrix12d correlations = in_sigmas(belief.covariance, belief.covariance);
    EXPECT_LT((correlations - correlations.transpose()).norm(), 1e-9) << i;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix12d>(correlations).eigenvalues().minCoeff(), 0.0) << i;
  }
}

TEST(SeenTurn, KnowsNoBetterWhereTheCameraWas) {
  RandomStream random(3);
  MotionBelief before = any_motion(random, false);
  before.covariance.topLeftCorner<6, 6>() = 4.0 * Matrix6d::Identity();
  before.covariance.block<3, 3>(3, 3) *= 0.01;
  const SeenTurn seen = any_turn(random, before, 0.02);
  // Metres and 11 degrees, which a step of 40 ms at the speeds known adds little to.
  const Matrix12d after = turned_by(before, kStep, seen).belief.covariance;
  for (int k = 0; k < 6; ++k) EXPECT_GT(after(k, k), 0.99 * (k < 3 ? 4.0 : 0.04)) << k;
}

TEST(SeenTurn, IsNotBelievedFarFromWhatTheMotionExpects) {
  RandomStream random(4);
  int believed = 0, not_believed = 0;
  for (const double sigmas : {3.0, 4.8, 5.2, 30.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      const MotionBelief before = any_motion(random, false);
      SeenTurn seen = any_turn(random, before, 0.0);
      const Eigen::Quaterniond expected = seen.turn.R_before_now;
      // The distance is as good as linear in how far it is off.
      double off = 0.1;
      for (int k = 0; k < 20; ++k) {
        seen.turn.R_before_now = expected * rotation_exp(off * Vector3d::Unit(axis));
        off *= sigmas / WholeUpdate(before, kStep, seen).sigmas;
        if (off > 3.0) break;
      }
      if (off > 3.0) continue;
      const WholeUpdate whole(before, kStep, seen);
      const TurnedBelief turned = turned_by(before, kStep, seen);
      const double from_alone = difference(whole.alone.mean, turned.belief.mean).norm();
      const double width = (in_sigmas(turned.belief.covariance, whole.alone.covariance) -
                            in_sigmas(whole.alone.covariance, whole.alone.covariance))
                               .norm();
      if (sigmas > 5.0) {
        EXPECT_LT(from_alone, 1e-9) << sigmas << ", " << axis;
        EXPECT_LT(width, 1e-5) << sigmas << ", " << axis;
        EXPECT_NEAR(turned.log_likelihood, whole.log_density + 0.5 * (whole.sigmas * whole.sigmas - 25.0),
                    0.05);
        ++not_believed;
      } else {
        EXPECT_GT(from_alone, 0.1) << sigmas << ", " << axis;
        EXPECT_GT(width, 0.1) << sigmas << ", " << axis;
        ++believed;
      }
    }
  }
  EXPECT_GE(believed, 4);
  EXPECT_GE(not_believed, 3);
}

TEST(SeenTurn, IsAsLikelyAsItsDensity) {
  // But for the constant 3/2 ln(2 pi), which tells no two motions apart.
  RandomStream random(5);
  for (int i = 0; i < 20; ++i) {
    const MotionBelief before = any_motion(random, false);
    const SeenTurn seen = any_turn(random, before, 0.02);
    EXPECT_NEAR(turned_by(before, kStep, seen).log_likelihood, WholeUpdate(before, kStep, seen).log_density,
                0.1)
        << i;
  }
}

TEST(SeenTurn, MayBeAWayGoneAsWell) {
  // A camera that certainly does not turn, before a point straight ahead: what is seen is its way.
  MotionBelief at_rest;
  at_rest.covariance.diagonal() << Vector6d::Constant(1e-12), Vector3d::Constant(100.0),
      Vector3d::Constant(1e-12);
  const MotionStep step{.noise = {.linear_m2_per_s3 = 1e-9, .angular_rad2_per_s3 = 1e-9}, .dt_s = 0.04};
  for (const Vector3d& way : {Vector3d(0.1, 0.0, 0.0), Vector3d(0.0, 0.1, 0.0), Vector3d(-0.05, 0.03, 0.0)}) {
    const Vector3d point(0.0, 0.0, 2.0);
    SeenTurn seen;
    seen.scene_camera = point;
    seen.turn.R_before_now = turn_between(point, point - way);
    seen.turn.sigma_rad = 1e-3;
    const TurnedBelief turned = turned_by(at_rest, step, seen);
    EXPECT_LT((turned.belief.mean.pose.translation() - way).norm(), 1e-3) << way.transpose();
    EXPECT_LT((turned.belief.mean.velocity.head<3>() - way / 0.04).norm(), 0.03) << way.transpose();
  }
}

TEST(SeenTurn, TurnsWhereTheMotionDidNot) {
  // Nothing is known of the turning; R_before_now is on the right of the pose before.
  RandomStream random(6);
  MotionBelief before;
  before.mean.pose = {rotation_exp({1.0, -0.5, 2.0}), {1.0, 2.0, 3.0}};
  before.covariance.diagonal() << Vector6d::Constant(1e-12), Vector3d::Constant(1e-6),
      Vector3d::Constant(100.0);
  const Vector3d turn(0.1, -0.2, 0.05);
  const SeenTurn seen{{rotation_exp(turn), 1e-3}, {0.0, 0.0, 2.0}};
  const MotionState now = turned_by(before, kStep, seen).belief.mean;
  EXPECT_THAT(now.pose, PoseNear(before.mean.pose * Pose(rotation_exp(turn), Vector3d::Zero()), 0.01, 0.002));
  EXPECT_LT((now.velocity.tail<3>() - turn / kStep.dt_s).norm(), 0.3);
}

TEST(SeenTurn, FindsTruePathsAsOftenAsItClaims) {
  // Draws of the motion before, of what kicked it since, and of what was seen: the squares of their errors,
  // in what the belief claims, are 1 in the mean.
  RandomStream random(7);
  MotionBelief before = any_motion(random, false);
  before.covariance.bottomRightCorner<6, 6>() *= 0.25;
  const Matrix12d root = before.covariance.llt().matrixL();
  MotionBelief exact{before.mean};
  const Matrix12d kick = predicted(exact, kStep).covariance.llt().matrixL();
  const auto normal12 = [&] {
    Vector12d v;
    for (double& value : v) value = random.normal();
    return v;
  };
  constexpr int kDraws = 4000;
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const MotionState then = moved(before.mean, root * normal12());
    const MotionState now = moved(predict(then, kStep.dt_s), kick * normal12());
    const Pose way = then.pose.inverse() * now.pose;
    SeenTurn seen{{{}, 0.02}, {0.3, -0.2, 2.0}};
    seen.turn.R_before_now = turn_between(seen.scene_camera, seen.scene_camera - way.translation()) *
                             way.rotation() * rotation_exp(random3(random, seen.turn.sigma_rad));
    const MotionBelief found = turned_by(before, kStep, seen).belief;
    const Vector12d error = difference(found.mean, now);
    sum += error.dot(found.covariance.ldlt().solve(error)) / 12.0;
  }
  EXPECT_NEAR(sum / kDraws, 1.0, 0.05);
}

TEST(MotionStep, OfADoubtfulSpeedSpreadsThePoseAlongItsWay) {
  MotionBelief belief;
  belief.mean.velocity << 1.0, -2.0, 0.0, 0.0, 0.0, 3.0;
  const MotionStep sure{.noise = {}, .dt_s = 0.1}, doubtful{.noise = {}, .dt_s = 0.1, .speed_sigma = 0.2};
  const MotionBelief one = predicted(belief, sure), other = predicted(belief, doubtful);
  Vector6d way;
  way << 0.1 * predict(belief.mean, 0.1).velocity;
  Matrix12d expected = Matrix12d::Zero();
  expected.topLeftCorner<6, 6>() = 0.04 * way * way.transpose();
  EXPECT_LT((other.covariance - one.covariance - expected).norm(), 1e-12);
}

}  // namespace
}  // namespace apriltrack::test
