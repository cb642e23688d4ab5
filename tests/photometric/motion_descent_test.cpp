#include "motion_descent.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

#include "apriltrack/base/random.h"
#include "tag_film.h"

namespace apriltrack {
namespace {

/// No tag is in sight, so that the prior is all there is: its mean is the minimum, and half of the squared
/// standard deviations from there the cost. Translation and velocity are mixed, so that no single number is
/// as badly known as the weakest direction, which is known a million times worse than the strongest.
class LongValley : public ::testing::Test {
 protected:
  static constexpr int kNumMixed = 9;

  LongValley() : film_({{400.0, 400.0, 159.5, 119.5}, NoDistortion{}}, Motion()), world_(film_.world()) {
    RandomStream random(12);
    Eigen::Matrix<double, kNumMixed, kNumMixed> mixed;
    for (double& value : mixed.reshaped()) value = random.normal();
    const Eigen::Matrix<double, kNumMixed, kNumMixed> axes = mixed.householderQr().householderQ();
    const std::vector<int> numbers = {0, 1, 2, 6, 7, 8, 9, 10, 11};
    for (int axis = 0; axis < kNumMixed; ++axis) {
      Vector12d step = Vector12d::Zero();
      const double sigma = std::pow(10.0, -3.0 * axis / (kNumMixed - 1));  // variances from 1 to 1e-6
      for (int i = 0; i < kNumMixed; ++i) step[numbers[static_cast<std::size_t>(i)]] = sigma * axes(i, axis);
      one_sigma_.push_back(step);
      prior_->covariance += step * step.transpose();
    }
    prior_->covariance.diagonal().segment<3>(3).setConstant(1e-4);
    prior_->mean.pose = Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, -3.0});  // behind the camera
  }

  struct End {
    bool has_settled;
    double sigmas;  ///< From the minimum.
  };
  /// From so many standard deviations along an axis; 0 is the weakest.
  End descended(int axis, double sigmas, int level = 0, int max_steps = 30) {
    MotionObjective objective(world_, film_.frame, prior_, no_corners_);
    EvaluatedState current, spare;
    objective.choose_pixels(moved(prior_->mean, sigmas * one_sigma_[static_cast<std::size_t>(axis)]),
                            {.level = level});
    EXPECT_FALSE(objective.has_pixels());
    objective.evaluate_chosen(current);
    const bool has_settled = descend(objective, max_steps, current, spare);
    return {has_settled, distance(*prior_, current.state)};
  }

  test::TagFilm film_;
  PhotometricWorld world_;
  std::vector<CornerObservation> no_corners_;
  std::optional<MotionBelief> prior_ = MotionBelief();
  std::vector<Vector12d> one_sigma_;
};

TEST_F(LongValley, IsFollowedToTheMinimumFromEveryDirection) {
  // A tenth is negligible; steps towards one axis that stray a little to weaker ones leave about as much.
  constexpr double kNegligibleSigmas = 0.2;
  for (int axis = 0; axis < kNumMixed; ++axis) {
    for (const double sigmas : {1.0, 10.0}) {
      const End end = descended(axis, sigmas);
      EXPECT_TRUE(end.has_settled) << axis;
      EXPECT_LT(end.sigmas, kNegligibleSigmas) << axis << " from " << sigmas;
    }
  }
}

TEST_F(LongValley, IsLeftWhereTheStepAheadIsNegligible) {
  // Squared: 0.01 on the finest level, 0.25 on the coarser ones.
  for (const auto& [level, settled, unsettled] : {std::tuple{0, 0.09, 0.15}, std::tuple{1, 0.45, 0.6}}) {
    for (const int axis : {0, 4, 8}) {
      EXPECT_NEAR(descended(axis, settled, level).sigmas, settled, 1e-6) << level << " " << axis;
      EXPECT_LT(descended(axis, unsettled, level).sigmas, 0.9 * unsettled) << level << " " << axis;
    }
  }
}

TEST_F(LongValley, IsUnsettledWhenTheStepsAreSpent) {
  const End end = descended(0, 100.0, 0, 1);
  EXPECT_FALSE(end.has_settled);
  EXPECT_LT(end.sigmas, 100.0);
}

}  // namespace
}  // namespace apriltrack
