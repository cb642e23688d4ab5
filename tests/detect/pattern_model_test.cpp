#include "pattern_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "apriltrack/tags/tag_family.h"
#include "support/numeric_jacobian.h"
#include "tag_quad.h"

namespace apriltrack {
namespace {

const TagPattern& shown_pattern() {
  static const TagPattern pattern = TagFamily::get("tag36h11").pattern(17);
  return pattern;
}

/// A tag of about `side_px` seen askew; its middle lies at (200, 150).
PatternState askew(double side_px) {
  Eigen::Matrix3d straight_from_tag;
  straight_from_tag << 0.5, 0.1, 0.0, -0.06, 0.45, 0.0, 0.04 / side_px, 0.1 / side_px, 1.0 / side_px;
  straight_from_tag *= side_px;
  Eigen::Matrix3d moved = Eigen::Matrix3d::Identity();
  moved.topRightCorner<2, 1>() = Eigen::Vector2d(200.0, 150.0);
  PatternState state;
  state.tag_from_straight = (moved * straight_from_tag).inverse();
  state.blur_px2 << 0.5, 0.1, 0.1, 0.4;
  state.bend = Eigen::Vector3d(1.2e-4, -0.7e-4, 1e-7);
  state.colours << 0.6, 0.05, -0.04, 0.1, 0.01, 0.02, 0.0, 0.0, 0.0, 0.0;
  return state;
}

PatternState moved_by(PatternState state, const Eigen::VectorXd& asked) {
  PatternStep step = asked;
  state.take(&step, 1.0);
  return state;
}

TEST(PatternStateTest, TellsTheStepThatItTook) {
  const PatternState before = askew(60.0);
  PatternState state = before;
  PatternStep step = PatternStep::Zero();
  step[kPlaceUnknowns] = 3.0;
  step.segment<3>(kBlurUnknowns) << -0.9, 0.1, -0.2;  // further than to nothing
  EXPECT_EQ(state.take(&step, 0.5), 0.5);
  EXPECT_EQ(step[kPlaceUnknowns], 0.5);
  EXPECT_GT(state.blur_px2.determinant(), 0.0);
  EXPECT_NEAR(step[kBlurUnknowns], state.blur_px2(0, 0) - before.blur_px2(0, 0), 1e-15);
  EXPECT_NEAR(step[kBlurUnknowns + 1], state.blur_px2(0, 1) - before.blur_px2(0, 1), 1e-15);
  EXPECT_NEAR(step[kBlurUnknowns + 2], state.blur_px2(1, 1) - before.blur_px2(1, 1), 1e-15);
}

class PatternModelTest : public ::testing::Test {
 protected:
  BlurredPattern blurred_{shown_pattern()};
  TagPlaces places_ = *TagPlaces::about({200.0, 150.0}, nullptr);
  PatternModel model_{blurred_, places_};
};

TEST_F(PatternModelTest, CornersAreWherePixelsShowThem) {
  // The model straightens a pixel x by x - b(x), and so must the corner be straightened.
  for (const double side_px : {60.0, 120.0, 300.0}) {
    const PatternState state = askew(side_px);
    const auto corners = model_.corners(state);
    ASSERT_TRUE(corners);
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const Eigen::Vector2d out = corners->px[k] - places_.middle();
      const Eigen::Vector2d bend_px = out.squaredNorm() * (state.bend.head<2>() + state.bend[2] * out);
      const Eigen::Vector2d unbent = corners->px[k] - bend_px;
      const Eigen::Vector2d shown =
          (state.tag_from_straight.inverse() * kTagQuad[k].homogeneous()).hnormalized();
      EXPECT_LT((unbent - shown).norm(), 1e-6) << side_px;
    }
  }
}

TEST_F(PatternModelTest, CornersOfAFoldedPictureAreNone) {
  PatternState state = askew(300.0);
  state.bend *= 100.0;
  EXPECT_FALSE(model_.corners(state));
}

TEST_F(PatternModelTest, CornersFollowPlaceAndBend) {
  const PatternState state = askew(120.0);
  // In steps that are worth about a pixel.
  PatternStep unit = PatternStep::Ones();
  unit.head<8>() *= 0.02;
  unit.segment<3>(kBendUnknowns) << 1e-4, 1e-4, 1e-6;
  const auto corners_after = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    const auto corners = model_.corners(moved_by(state, unit.cwiseProduct(step)));
    Eigen::VectorXd px(8);
    for (std::size_t k = 0; k < kNumCorners; ++k)
      px.segment<2>(2 * static_cast<Eigen::Index>(k)) = corners->px[k];
    return px;
  };
  EXPECT_TRUE(test::jacobians_agree(model_.corners(state)->by_unknowns * unit.asDiagonal(),
                                    test::numeric_jacobian(corners_after, kNumPatternUnknowns, 1e-4), 1e-6));
}

TEST_F(PatternModelTest, DerivativesAreThoseOfThePrediction) {
  // Head-on, under even light, on white paper: what the derivatives by the place leave out is nothing there.
  PatternState state = askew(60.0);
  Eigen::Matrix3d straight_from_tag;
  straight_from_tag << 30.0, 4.0, 200.0, -4.0, 30.0, 150.0, 0.0, 0.0, 1.0;
  state.tag_from_straight = straight_from_tag.inverse();
  state.bend.setZero();
  state.colours << 0.6, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  std::vector<PatternPixel> pixels;
  for (int y = 110; y < 190; y += 3)
    for (int x = 160; x < 240; x += 3) pixels.push_back({Eigen::Vector2d(x, y), 0.3, x, y});
  // In steps that are worth about a pixel, or a tenth of the light.
  PatternStep unit = PatternStep::Constant(0.1);
  unit.head<8>().setConstant(0.03);
  unit.segment<3>(kBendUnknowns) << 1e-3, 1e-3, 1e-5;
  constexpr double kSameTexture = 0.4;
  PatternPrediction at;
  model_.predict(state, pixels, kSameTexture, &at);
  const auto light_after = [&](const Eigen::VectorXd& step) -> Eigen::VectorXd {
    PatternPrediction prediction;
    model_.predict(moved_by(state, unit.cwiseProduct(step)), pixels, kSameTexture, &prediction);
    return -prediction.residuals;
  };
  const Eigen::MatrixXd numeric = test::numeric_jacobian(light_after, kNumPatternUnknowns, 1e-3);
  const Eigen::MatrixXd analytic = at.by_unknowns.transpose() * unit.asDiagonal();
  for (int k = 0; k < kNumPatternUnknowns; ++k) {
    const double scale = numeric.col(k).norm();
    EXPECT_GT(scale, 0.0) << k;
    // What stretches the plane stretches the blur in it, which is left to the next step.
    const bool is_stretch = k >= 2 && k < 8;
    EXPECT_LT((numeric.col(k) - analytic.col(k)).norm(), (is_stretch ? 0.05 : 1e-5) * scale) << k;
  }
}

}  // namespace
}  // namespace apriltrack
