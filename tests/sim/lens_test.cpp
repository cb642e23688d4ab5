#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lens_scene.h"

namespace apriltrack {
namespace {

using namespace test;

constexpr double kLensSigmas_px[] = {0.2, 0.3, 0.35, 0.4, 0.47, 0.5, 0.7, 1.0, 1.2};
constexpr double kMaxStepError = 1.1e-3;  // of full light
constexpr double kFar_px = 100.0;         // beyond the picture

double phase_px(int i) {  // Places in a pixel that hit no lattice's points alone.
  return 0.377 * i - std::floor(0.377 * i);
}

template <typename Truth>
double largest_light_error(const Image<float>& light, const Truth& truth) {
  double largest = 0.0;
  for (int y = 8; y < kLensHeight - 8; ++y) {
    for (int x = 8; x < kLensWidth - 8; ++x)
      largest = std::max(largest, std::abs(light(x, y) - truth(from_middle_x(x), from_middle_y(y))));
  }
  return largest;
}

TEST(Lens, MakesOfAnEdgeTheIntegratedNormalDistribution) {
  for (const double sigma_px : kLensSigmas_px) {
    const BlurredStep step(sigma_px);
    for (int i = 0; i < 8; ++i) {
      const double edge = phase_px(i);
      const auto upright =
          light_behind(lens_scene(sigma_px, white_panel({edge + kFar_px, 0}, {kFar_px, kFar_px})));
      const auto level =
          light_behind(lens_scene(sigma_px, white_panel({0, edge + kFar_px}, {kFar_px, kFar_px})));
      EXPECT_LT(largest_light_error(upright, [&](double x, double) { return step.upright(x - edge); }),
                kMaxStepError)
          << sigma_px << ' ' << edge;
      EXPECT_LT(largest_light_error(level, [&](double, double y) { return step.upright(y - edge); }),
                kMaxStepError)
          << sigma_px << ' ' << edge;
    }
  }
}

/// A turned pixel is made of upright parts, whose shape adds to the error: of 2 x 2 of them where lenses of
/// 32 looks share the exposure, else of 4 x 4.
TEST(Lens, MakesOfATurnedEdgeTheIntegratedNormalDistribution) {
  for (const double sigma_px : kLensSigmas_px) {
    const BlurredStep step(sigma_px);
    for (const double turn : {0.1, 0.4636, 0.6, 0.7854, 1.2, -0.4}) {
      const double c = std::cos(turn), s = std::sin(turn);
      const double edge = phase_px(static_cast<int>(10 * turn) + 5);
      const Eigen::Vector2d centre((edge + kFar_px) * c, (edge + kFar_px) * s);
      const auto light = light_behind(lens_scene(sigma_px, white_panel(centre, {kFar_px, kFar_px}, turn)));
      const auto truth = [&](double x, double y) {
        return step.over_boxes(c * x + s * y - edge, std::abs(c), std::abs(s));
      };
      EXPECT_LT(largest_light_error(light, truth), sigma_px < 0.35 ? 3.5e-3 : 2e-3)
          << sigma_px << ' ' << turn;
    }
  }
}

TEST(Lens, MakesOfACornerTheProductOfTwoEdges) {
  for (const double sigma_px : kLensSigmas_px) {
    const BlurredStep step(sigma_px);
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector2d corner(phase_px(i), phase_px(3 * i + 1));
      const auto light = light_behind(
          lens_scene(sigma_px, white_panel(corner + Eigen::Vector2d(kFar_px, kFar_px), {kFar_px, kFar_px})));
      const auto truth = [&](double x, double y) {
        return step.upright(x - corner.x()) * step.upright(y - corner.y());
      };
      EXPECT_LT(largest_light_error(light, truth), kMaxStepError) << sigma_px << ' ' << corner.transpose();
    }
  }
}

TEST(Lens, LeavesABarItsEdges) {
  int count = 0;
  for (const double sigma_px : {0.3, 0.5, 0.8, 1.2}) {
    const BlurredStep step(sigma_px);
    for (const double width : {2.0, 2.7, 3.5}) {
      for (int i = 0; i < 8; ++i, ++count) {
        const double left = phase_px(i), right = left + width;
        const auto light = light_behind(
            lens_scene(sigma_px, white_panel({0.5 * (left + right), 0}, {0.5 * width, kFar_px})));
        // One step of least squares for both edges, from the truth.
        Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
        Eigen::Vector2d pull = Eigen::Vector2d::Zero();
        for (int pixel = 8; pixel < kLensWidth - 8; ++pixel) {
          const double x = from_middle_x(pixel);
          const Eigen::Vector2d by_edges(-step.slope(x - left), step.slope(x - right));
          normal += by_edges * by_edges.transpose();
          pull += by_edges * (light(pixel, 24) - (step.upright(x - left) - step.upright(x - right)));
        }
        const Eigen::Vector2d shift = normal.inverse() * pull;
        EXPECT_LT(shift.cwiseAbs().maxCoeff(), kMaxLensShift_px) << sigma_px << ' ' << width << ' ' << left;
      }
    }
  }
  EXPECT_EQ(count, 4 * 3 * 8);
}

TEST(Lens, HasTheVarianceThatItSaysAndKeepsLightAndPlace) {
  for (const double sigma : {0.3, 0.5, 1.0, 2.3}) {
    constexpr double kDot_px = 0.5;
    constexpr int kPlaces = 7;  // whose mean sees neither pixels nor looks
    double sum = 0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
      const Eigen::Vector2d place((i % kPlaces + 0.5) / kPlaces, (i / kPlaces + 0.5) / kPlaces);
      const auto light = light_behind(lens_scene(sigma, white_panel(place, {0.5 * kDot_px, 0.5 * kDot_px})));
      for (int y = 0; y < kLensHeight; ++y) {
        for (int x = 0; x < kLensWidth; ++x) {
          const Eigen::Vector2d away = Eigen::Vector2d(from_middle_x(x), from_middle_y(y)) - place;
          sum += light(x, y);
          mean += light(x, y) * away;
          squares += light(x, y) * away.cwiseAbs2();
        }
      }
    }
    const double variance = sigma * sigma + kDot_px * kDot_px / 12.0 + 1.0 / 12.0;
    EXPECT_NEAR(sum / (kPlaces * kPlaces * kDot_px * kDot_px), 1.0, 1e-4) << sigma;
    EXPECT_NEAR(mean.x() / sum, 0.0, 1e-4) << sigma;
    EXPECT_NEAR(mean.y() / sum, 0.0, 1e-4) << sigma;
    EXPECT_NEAR(squares.x() / sum, variance, 1e-4 * (1 + sigma * sigma)) << sigma;
    EXPECT_NEAR(squares.y() / sum, variance, 1e-4 * (1 + sigma * sigma)) << sigma;
  }
}

TEST(Lens, LeavesAnEvenPictureEvenUpToTheBorder) {
  for (const double sigma : kLensSigmas_px) {
    const auto light = light_behind(lens_scene(sigma, white_panel({0, 0}, {kFar_px, kFar_px})));
    for (int y = 0; y < kLensHeight; ++y) {
      for (int x = 0; x < kLensWidth; ++x) ASSERT_NEAR(light(x, y), 1.0, 1e-6);
    }
  }
}

/// An edge that moves evenly, across or down: its blurred step meets the box of the way. The looks take
/// turns, so that few of them meet the edge near a pixel; but they pull it neither way.
TEST(Lens, AddsToTheWayOfTheExposure) {
  constexpr double kExposure_s = 0.02;
  constexpr double kMaxErrorOnTheWay = 0.02;
  int count = 0;
  for (const double sigma_px : {0.3, 0.5, 1.0}) {
    const BlurredStep step(sigma_px);
    for (const double way_px : {-7.0, -6.0, -4.0, -1.0, 0.5, 3.0, 4.0, 6.0, 9.0, 20.0}) {
      for (const int axis : {0, 1}) {
        const double edge = phase_px(++count);
        Eigen::Vector2d centre(0, 0);
        centre[axis] = edge + kFar_px;
        Body body = white_panel(centre, {kFar_px, kFar_px});
        body.T_world_body.position_m[static_cast<std::size_t>(axis)].rate_per_s =
            way_px / kLensFocal_px / kExposure_s;
        const auto light = light_behind(lens_scene(sigma_px, body), kExposure_s);
        const auto truth = [&](double x, double y) {
          return step.over_boxes((axis == 0 ? x : y) - edge, 1.0, std::abs(way_px));
        };
        const double largest = largest_light_error(light, truth);
        double shift = 0;
        for (int i = 0; i < (axis == 0 ? kLensWidth : kLensHeight); ++i) {
          const int x = axis == 0 ? i : kLensWidth / 2, y = axis == 0 ? kLensHeight / 2 : i;
          shift += light(x, y) - truth(from_middle_x(x), from_middle_y(y));
        }
        EXPECT_LT(largest, kMaxErrorOnTheWay) << sigma_px << ' ' << way_px << ' ' << axis;
        EXPECT_LT(std::abs(shift), kMaxLensShift_px) << sigma_px << ' ' << way_px << ' ' << axis;
      }
    }
  }
}

/// What is too bright for the sensor was blurred before it was clipped.
TEST(Lens, BlursLightAndNotCodes) {
  constexpr double kBright = 4.0;
  Scene scene = lens_scene(0.5, white_panel({kFar_px, 0}, {kFar_px, kFar_px}));
  scene.formation.sensor_gain = kBright;
  scene.camera.response = ResponseCurve::linear();
  const RenderedFrame frame = Renderer(scene).render(0);
  const BlurredStep step(0.5);
  int num_clipped = 0;
  for (int x = 8; x < kLensWidth - 8; ++x) {
    const double light = kBright * step.upright(from_middle_x(x));
    EXPECT_NEAR(frame.pixels(x, 24), 255.0 * std::min(light, 1.0), 0.5 + 255.0 * kBright * kMaxStepError)
        << x;
    num_clipped += light > 1.0 && light < kBright - 0.1 ? 1 : 0;
  }
  EXPECT_EQ(num_clipped, 2);  // on the edge and beside it: codes blurred would show less
}

}  // namespace
}  // namespace apriltrack
