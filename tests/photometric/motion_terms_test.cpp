#include "motion_terms.h"

#include <gtest/gtest.h>

#include "support/numeric_jacobian.h"
#include "tag_film.h"

namespace apriltrack {
namespace {

/// A body's state one step of which is a centimetre or a hundredth of a radian from what is expected.
class MotionTerms : public ::testing::Test {
 protected:
  MotionTerms() : film_({{400.0, 405.0, 155.0, 122.0}, NoDistortion{}}, motion()), world_(film_.world()) {
    for (const double x : {-0.08, 0.08}) {
      for (const double y : {-0.08, 0.08}) {
        const Eigen::Vector3d point(x, y, 0.0);
        const auto pixel = world_.model.project(film_.truth.pose * point);
        corners_.push_back({point, *pixel + Eigen::Vector2d(30.0 * x, 2.0), 0.8});  // 2 to 4 sigma off
      }
    }
    corners_.push_back({Eigen::Vector3d(0.0, 0.0, -5.0), {10.0, 10.0}, 0.8});  // behind the camera
  }

  static Motion motion() {
    Motion motion;
    motion.T_end = {rotation_exp({0.3, 0.2, 0.1}), Eigen::Vector3d::Zero()};
    motion.position_m[0].rate_per_s = 0.9;
    motion.position_m[2] = {.offset = 0.62, .rate_per_s = 0.5, .waves = {}, .bursts = {}};
    return motion;
  }

  test::TagFilm film_;
  PhotometricWorld world_;
  std::vector<CornerObservation> corners_;
};

/// Of a cost of twelve numbers, at 0.
template <class Cost>
Vector12d slope(const Cost& cost) {
  const auto as_vector = [&](const Eigen::VectorXd& step) {
    return Eigen::VectorXd::Constant(1, cost(Vector12d(step)));
  };
  return test::numeric_jacobian(as_vector, 12).transpose();
}

TEST_F(MotionTerms, SlopeOfTheCornersIsThatOfTheirCost) {
  const CornerTerm term(world_, corners_);
  MotionEquations equations;
  term.add_to(equations, film_.truth);
  const Vector12d expected = slope([&](const Vector12d& step) {
    MotionState state = film_.truth;
    state.pose = Pose::exp(step.head<6>()) * state.pose;
    return term.cost(state);
  });
  EXPECT_GT(expected.norm(), 1.0);
  EXPECT_LT((equations.g - expected).norm(), 1e-5 * expected.norm()) << equations.g.transpose() << "\n"
                                                                     << expected.transpose();
  EXPECT_EQ(equations.H.rightCols<6>().norm(), 0.0);  // of the rate they say nothing
}

TEST_F(MotionTerms, SlopeOfThePriorIsThatOfItsCost) {
  Matrix12d covariance = Matrix12d::Identity() * 1e-3;
  covariance(0, 6) = covariance(6, 0) = 4e-4;
  const Vector12d off = Vector12d::Constant(0.01);
  const std::optional<MotionBelief> belief = MotionBelief{moved(film_.truth, off), covariance};
  const PriorTerm term(belief);
  MotionEquations equations;
  term.add_to(equations, film_.truth);
  const Vector12d expected =
      slope([&](const Vector12d& step) { return term.cost(moved(film_.truth, step)); });
  // A turn of 0.017 rad bends the space of poses by about a hundredth.
  EXPECT_LT((equations.g - expected).norm(), 0.02 * expected.norm()) << equations.g.transpose() << "\n"
                                                                     << expected.transpose();
  EXPECT_NEAR(equations.worth(equations.step()), 2.0 * term.cost(film_.truth), 1e-9);
}

TEST_F(MotionTerms, NothingIsSaidByNoPrior) {
  const std::optional<MotionBelief> none;
  const PriorTerm term(none);
  MotionEquations equations;
  term.add_to(equations, film_.truth);
  EXPECT_EQ(term.cost(film_.truth), 0.0);
  EXPECT_EQ(equations.H.norm() + equations.g.norm(), 0.0);
}

}  // namespace
}  // namespace apriltrack
