#include "blur_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tag_picture.h"

namespace apriltrack {
namespace {

constexpr double kMetresPerPixel = test::TagPicture::kDepth_m / test::TagPicture::kFocal_px;

/// The picture, and what is believed of it beforehand: all but certain in most directions, so that a grid can
/// look everywhere else.
class SearchedPicture : public ::testing::Test {
 protected:
  static constexpr double kNarrow = 1e-4;

  MotionBelief belief_of(const MotionState& mean, const Vector12d& sigma) const {
    MotionBelief belief{mean, Matrix12d::Zero()};
    belief.covariance = sigma.cwiseMax(kNarrow).cwiseAbs2().asDiagonal();
    return belief;
  }
  /// The truth, shifted along the axes of the tag, and believed to be within some 12 px of there.
  MotionBelief belief_off_by(double x_px, double y_px) const {
    Vector12d step = Vector12d::Zero(), sigma = Vector12d::Zero();
    step.head<2>() << x_px * kMetresPerPixel, y_px * kMetresPerPixel;
    sigma.head<2>().setConstant(12.0 * kMetresPerPixel);
    return belief_of(moved(picture_.truth, step), sigma);
  }
  /// What the last round of the search maximises.
  double score(const MotionState& state, const MotionBelief& belief) {
    const EvidenceOptions options{
        .level = 2, .max_pixels_per_tag = 196, .extra_sigma_px = 1.4, .is_robust = false};
    const double sigmas = distance(belief, state);
    return log_likelihood(weigh_evidence(world_, frame_, state, options)) -
           std::min(15.0, 0.5 * sigmas * sigmas);
  }
  double shift_px(const MotionState& a, const MotionState& b) const {
    return (a.pose.translation() - b.pose.translation()).norm() / kMetresPerPixel;
  }
  std::vector<MotionState> search(const MotionBelief& belief, const std::vector<MotionState>& seeds = {},
                                  const CloudOptions& options = {}) {
    std::vector<MotionState> states;
    for (const CloudState& found : search_cloud(world_, frame_, {belief}, seeds, options))
      states.push_back(found.state);
    return states;
  }

  test::TagPicture picture_;
  PhotometricFrame frame_ = picture_.frame();
  PhotometricWorld world_ = picture_.world();
};

TEST_F(SearchedPicture, IsAsGoodAsTheBestOfAGrid) {
  for (const auto& [x_px, y_px] : {std::pair{14.0, -10.0}, std::pair{-18.0, 6.0}}) {
    const MotionBelief belief = belief_off_by(x_px, y_px);
    MotionState best_of_grid;
    double most = -1e9;
    for (double x = -36.0; x <= 36.0; x += 1.0) {  // three standard deviations
      for (double y = -36.0; y <= 36.0; y += 1.0) {
        Vector12d step = Vector12d::Zero();
        step.head<2>() << x * kMetresPerPixel, y * kMetresPerPixel;
        const MotionState state = moved(belief.mean, step);
        const double value = score(state, belief);
        if (value > most) best_of_grid = state;
        most = std::max(most, value);
      }
    }
    const std::vector<MotionState> found = search(belief);
    ASSERT_FALSE(found.empty());
    EXPECT_LT(shift_px(best_of_grid, picture_.truth), 1.0);
    EXPECT_LT(shift_px(found.front(), best_of_grid), 0.5);  // the grid's step is 1 px
    EXPECT_LT(shift_px(found.front(), picture_.truth), 0.5);
    // Nats of some 540; the grid stands on the truth.
    EXPECT_GT(score(found.front(), belief), most - 10.0);
    EXPECT_LT(score(belief.mean, belief), most - 500.0);
  }
}

TEST_F(SearchedPicture, GivesAFewStatesThatAreApart) {
  const MotionBelief belief = belief_off_by(14.0, -10.0);
  const std::vector<MotionState> found = search(belief);
  ASSERT_GE(found.size(), 2U);
  EXPECT_LE(found.size(), 6U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Vector6d d = difference(found[i], found[k]).head<6>();
      EXPECT_GT((d.array() / belief.covariance.diagonal().head<6>().cwiseSqrt().array()).matrix().norm(),
                0.3);
    }
  }
  // By half as many pixels: what explains nothing is in no order.
  for (std::size_t i = 1; i < found.size(); ++i)
    EXPECT_GE(score(found[i - 1], belief), score(found[i], belief) - 8.0) << "best first";
}

TEST_F(SearchedPicture, LooksAtTheSeedsHoweverUnlikely) {
  // Five standard deviations off, and few particles: only a seed can be there.
  Vector12d step = Vector12d::Zero(), sigma = Vector12d::Zero();
  step.head<2>() << 60.0 * kMetresPerPixel, 0.0;
  sigma.head<2>().setConstant(12.0 * kMetresPerPixel);
  const MotionBelief belief = belief_of(moved(picture_.truth, step), sigma);
  const std::vector<MotionState> without = search(belief, {}, {.num_particles = 16});
  const std::vector<MotionState> with = search(belief, {picture_.truth}, {.num_particles = 16});
  ASSERT_FALSE(without.empty() || with.empty());
  EXPECT_GT(shift_px(without.front(), picture_.truth), 20.0);
  EXPECT_LT(shift_px(with.front(), picture_.truth), 1.0);
}

TEST_F(SearchedPicture, TellsAPathFromItsReverseByTheMotionSoFar) {
  for (const double sign : {1.0, -1.0}) {
    MotionState mean = picture_.truth;
    mean.velocity *= sign * 0.7;
    Vector12d sigma = Vector12d::Zero();
    sigma.tail<6>() = 0.35 * picture_.truth.velocity.cwiseAbs();
    const std::vector<MotionState> found = search(belief_of(mean, sigma));
    ASSERT_FALSE(found.empty());
    MotionState reversed = found.front();
    reversed.velocity = -reversed.velocity;
    EXPECT_NEAR(score(reversed, belief_of(reversed, sigma)),
                score(found.front(), belief_of(found.front(), sigma)), 5.0)
        << "they blur alike";
    const Vector6d ratio = found.front().velocity.cwiseQuotient(sign * picture_.truth.velocity);
    EXPECT_GT(ratio.head<3>().minCoeff(), 0.0);
    EXPECT_LT((found.front().velocity - sign * picture_.truth.velocity).head<3>().norm(), 0.4);  // of 0.8 m/s
  }
}

TEST_F(SearchedPicture, FindsTheSameAgainButNotWithOtherNumbers) {
  const MotionBelief belief = belief_off_by(14.0, -10.0);
  const auto numbers = [&](const CloudOptions& options) {
    std::vector<double> result;
    for (const MotionState& state : search(belief, {}, options)) {
      const Eigen::Matrix4d T = state.pose.matrix();
      result.insert(result.end(), T.data(), T.data() + 16);
      result.insert(result.end(), state.velocity.begin(), state.velocity.end());
    }
    return result;
  };
  const CloudOptions options{.num_particles = 40, .seed = 3, .index = 5};
  const std::vector<double> found = numbers(options);
  EXPECT_EQ(numbers(options), found);
  EXPECT_NE(numbers({.num_particles = 40, .seed = 4, .index = 5}), found);
  EXPECT_NE(numbers({.num_particles = 40, .seed = 3, .index = 6}), found);
}

}  // namespace
}  // namespace apriltrack
