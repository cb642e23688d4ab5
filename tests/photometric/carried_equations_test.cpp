#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/photometric/motion_fit.h"
#include "motion_objective.h"
#include "tag_film.h"

namespace apriltrack {
namespace {

/// A picture of a tag, and a state beside the truth from which a fit makes its last step alone: the equations
/// that it gives back are those of the start, carried to where the step leads.
class CarriedEquations : public ::testing::Test {
 protected:
  CarriedEquations()
      : film_({{400.0, 400.0, 159.5, 119.5}, NoDistortion{}}, motion()),
        world_(film_.world()),
        start_(film_.truth) {
    RandomStream random(3);
    Vector12d off;
    for (double& value : off) value = random.normal();
    const Matrix12d H = information_at(film_.truth);
    const Vector12d spread = H.diagonal().cwiseSqrt().cwiseInverse();
    off.array() *= spread.array();
    start_ = moved(film_.truth, kStartSigmas / std::sqrt(off.dot(H * off)) * off);
    // As sure as the pixels, so that the fit ends about half way: the tag is still pulled.
    prior_ = MotionBelief{start_, H.ldlt().solve(Matrix12d::Identity())};
  }

  static constexpr double kStartSigmas = 3.0;

  static Motion motion() {
    Motion motion;
    motion.T_end = {rotation_exp({0.4, 0.3, 0.1}), Eigen::Vector3d::Zero()};
    motion.position_m[0].rate_per_s = 0.6;
    motion.position_m[2].offset = 0.6;
    return motion;
  }
  ActiveTagsOptions as_at_the_end() const {
    return {.level = 0, .max_pixels = EvidenceOptions().max_pixels_per_tag, .more_where_sharp = true};
  }
  MotionObjective objective_at(const MotionState& state) {
    MotionObjective objective(world_, film_.frame, none_, no_corners_);
    objective.choose_pixels(state, as_at_the_end());
    return objective;
  }
  Matrix12d information_at(const MotionState& state) {
    const MotionObjective objective = objective_at(state);
    EvaluatedState evaluated;
    objective.evaluate_chosen(evaluated);
    return objective.equations(evaluated).H;
  }
  static Vector12d slope_at(const MotionObjective& objective, const MotionState& state,
                            const Matrix12d& sigmas) {
    constexpr double kStep = 0.2, kNoLimit = 1e9;
    const auto cost = [&](int axis, double step) {
      EvaluatedState evaluated;
      objective.evaluate(moved(state, step * sigmas.col(axis)), kNoLimit, evaluated);
      return evaluated.cost;
    };
    Vector12d slope;
    for (int i = 0; i < 12; ++i) slope[i] = (cost(i, kStep) - cost(i, -kStep)) / (2.0 * kStep);
    return slope;
  }

  test::TagFilm film_;
  PhotometricWorld world_;
  const std::optional<MotionBelief> none_;
  const std::vector<CornerObservation> no_corners_;
  MotionState start_;
  std::optional<MotionBelief> prior_;
};

TEST_F(CarriedEquations, HaveAboutTheSlopeOfTheTagsOwnCostWhereTheFitEnds) {
  const MotionFit fit =
      fit_motion(world_, film_.frame, start_, prior_, no_corners_, {.max_steps_per_level = 0});
  ASSERT_EQ(fit.equations.size(), 1U);
  ASSERT_GT(distance(*prior_, fit.state), 2.0);

  // The cost of the same pixels, by differences; everything per standard deviation of the state.
  const MotionObjective objective = objective_at(start_);
  const Matrix12d A = objective.view_by_state(fit.state);
  const Matrix12d H = A.transpose() * fit.equations[0].H * A;
  const Matrix12d sigmas = H.llt().matrixU().solve(Matrix12d::Identity());
  const Vector12d before = slope_at(objective, start_, sigmas),
                  after = slope_at(objective, fit.state, sigmas);
  const Vector12d carried = sigmas.transpose() * (A.transpose() * fit.equations[0].g);

  const Vector12d change = after - before, carried_change = carried - before;
  EXPECT_GT(change.norm(), 1.0);
  EXPECT_GT(change.dot(carried_change), 0.9 * change.norm() * carried_change.norm())
      << change.transpose() << "\n"
      << carried_change.transpose();
  // Gauss and Newton's curvature takes the weights of the pixels as given. Of residuals as large as their
  // scale, it is up to twice that of Geman and McClure's cost.
  EXPECT_GT(carried_change.norm(), change.norm());
  EXPECT_LT(carried_change.norm(), 2.0 * change.norm());
}

}  // namespace
}  // namespace apriltrack
