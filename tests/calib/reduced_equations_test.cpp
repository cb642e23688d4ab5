#include "solve/reduced_equations.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr int kTags = 4, kFrames = 5;

/// Each frame sees three of the tags; numbers drawn at random.
std::vector<LinearView> drawn_views() {
  RandomStream random(11);
  const auto draw = [&](auto& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix(i) = random.normal();
  };
  std::vector<LinearView> views;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int k = 0; k < 3; ++k) {
      LinearView& view = views.emplace_back();
      view.tag = (frame + k) % kTags;
      view.frame = frame;
      view.residual.resize(6);
      view.by_rig.resize(6, 6);
      view.by_tag.resize(6, 6);
      draw(view.residual);
      draw(view.by_rig);
      draw(view.by_tag);
    }
  }
  return views;
}

TEST(ReducedEquations, AreSolvedAsLeastSquaresOverAll) {
  const std::vector<LinearView> views = drawn_views();
  constexpr int kHeld = 1;
  const auto steps = solve_steps(views, kHeld);
  ASSERT_TRUE(steps.has_value());
  EXPECT_EQ(steps->tags.count(kHeld), 0U);

  const auto num_rows = static_cast<Eigen::Index>(6 * views.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(num_rows, 6 * (kTags + kFrames));
  Eigen::VectorXd b(num_rows);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    if (views[i].tag != kHeld) A.block<6, 6>(row, 6 * views[i].tag) = views[i].by_tag;
    A.block<6, 6>(row, 6 * (kTags + views[i].frame)) = views[i].by_rig;
    b.segment<6>(row) = -views[i].residual;
  }
  const Eigen::VectorXd best = A.completeOrthogonalDecomposition().solve(b);
  for (const auto& [tag, step] : steps->tags)
    EXPECT_LT((step - best.segment<6>(6 * tag)).norm(), 1e-8) << tag;
  for (const auto& [frame, step] : steps->frames)
    EXPECT_LT((step - best.segment<6>(6 * (kTags + frame))).norm(), 1e-8) << frame;
}

TEST(ReducedEquations, MoveFramesAloneWhereAllTagsAreHeld) {
  const std::vector<LinearView> views = drawn_views();
  const auto steps = solve_steps(views, std::nullopt);
  ASSERT_TRUE(steps.has_value());
  EXPECT_TRUE(steps->tags.empty());
  Eigen::Matrix<double, 18, 6> A;
  Eigen::Matrix<double, 18, 1> b;
  for (int k = 0; k < 3; ++k) {
    A.middleRows<6>(6 * k) = views[static_cast<std::size_t>(k)].by_rig;
    b.segment<6>(6 * k) = -views[static_cast<std::size_t>(k)].residual;
  }
  EXPECT_LT((steps->frames.at(0) - A.colPivHouseholderQr().solve(b)).norm(), 1e-9);
}

TEST(ReducedEquations, SayWhenATagIsUndetermined) {
  std::vector<LinearView> views = drawn_views();
  for (LinearView& view : views) {
    if (view.tag == 2) view.by_tag.col(3).setZero();
  }
  EXPECT_FALSE(solve_steps(views, 0).has_value());
}

}  // namespace
}  // namespace apriltrack
