#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <functional>
#include <map>
#include <string>

#include "apriltrack/calib/calibrate_map.h"
#include "calibrating.h"
#include "model/view_residual.h"
#include "synthetic_world.h"

// What the map says of its own errors, against the errors that it has.

namespace apriltrack {
namespace {

using test::SyntheticWorld;

/// Mean of xi^T C^-1 xi / 6 over tags and worlds: 1 when the covariance tells the truth. Independent of how
/// errors of different tags hang together, as every term has the mean 1.
double mean_normalised_error(const SyntheticWorld& world, const CalibrationOptions& options,
                             const std::function<void(std::vector<FrameDetections>&, RandomStream&)>& disturb,
                             int num_trials) {
  double sum = 0.0;
  int count = 0;
  for (int trial = 0; trial < num_trials; ++trial) {
    std::vector<FrameDetections> frames = test::exact_detections(world);
    RandomStream random(91, static_cast<std::uint64_t>(trial));
    disturb(frames, random);
    const CalibrationResult result = calibrate_map(frames, world.rig, world.sizes(), options);
    EXPECT_EQ(result.map.tags.size(), world.map.tags.size());
    for (const MapTag& tag : result.map.tags) {
      if (tag.key == result.held_tag) continue;
      sum += test::squared_sigmas_off(world, result.held_tag, tag) / 6.0;
      ++count;
    }
  }
  EXPECT_GT(count, 0);
  return sum / count;
}

TEST(MapCovarianceStatistics, ErrorsAreAsLargeAsItSays) {
  const SyntheticWorld world = test::make_room(10, 40, test::equidistant_camera());
  // The expected sigma is wrong by three on purpose: the residuals must correct it.
  const CalibrationOptions options{
      .corner_sigma_px = 0.5, .edge_end_correlation = -0.45, .corner_bias_px = 0.0};
  const double ratio = mean_normalised_error(
      world, options,
      [](auto& frames, RandomStream& random) { test::add_edge_noise(frames, 0.15, -0.45, random); }, 30);
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.25);
}

TEST(MapCovarianceStatistics, StaysUsefulWhenCornersErrIndependently) {
  // Not the detector's noise, but what corners from elsewhere may have: off by no more than the model's
  // mismatch.
  const SyntheticWorld world = test::make_room(10, 40, test::equidistant_camera());
  const double ratio = mean_normalised_error(
      world, {.edge_end_correlation = 0.0, .corner_bias_px = 0.0},
      [](auto& frames, RandomStream& random) { test::add_noise(frames, 0.15, random); }, 30);
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.25);
}

TEST(MapCovarianceStatistics, KnowsThatNeighbouringFramesRepeatTheirErrors) {
  // First-order autoregressive errors of every corner from view to view: five views are worth about one.
  const SyntheticWorld world = test::make_room(8, 240, test::equidistant_camera());
  constexpr double kRepeated = 0.7;  // 1 + 2 (0.7 + 0.49 + ...) = 5.7
  const double ratio = mean_normalised_error(
      world, {.edge_end_correlation = 0.0, .corner_bias_px = 0.0},
      [](auto& frames, RandomStream& random) {
        std::map<TagKey, Vector8d> errors;
        for (FrameDetections& frame : frames) {
          for (Detection& detection : frame.detections) {
            const bool is_first = !errors.contains(detection.tag);
            Vector8d& error = errors[detection.tag];
            for (int i = 0; i < 8; ++i) {
              const double fresh = 0.15 * random.normal();
              error[i] =
                  is_first ? fresh : kRepeated * error[i] + std::sqrt(1.0 - kRepeated * kRepeated) * fresh;
            }
            for (int c = 0; c < 4; ++c)
              detection.corners_px[static_cast<std::size_t>(c)] += error.segment<2>(2 * c);
          }
        }
      },
      20);
  EXPECT_GT(ratio, 0.6);  // views taken for independent: about 5
  EXPECT_LT(ratio, 1.6);
}

TEST(MapCovarianceStatistics, KnowsErrorsThatATagKeepsInAllItsViews) {
  // Constant normal errors at the ends of each tag's edges, under larger ones that are new in every view: too
  // small a share to be seen in the residuals, and all that is left in a long film.
  const SyntheticWorld world = test::make_room(8, 240, test::equidistant_camera());
  constexpr double kBias_px = 0.05;
  const auto disturb = [&](std::vector<FrameDetections>& frames, RandomStream& random) {
    test::add_edge_biases(frames, kBias_px, -0.45, random);
    test::add_edge_noise(frames, 0.15, -0.45, random);
  };
  const double told = mean_normalised_error(world, {.corner_bias_px = kBias_px}, disturb, 20);
  EXPECT_GT(told, 0.8);
  EXPECT_LT(told, 1.25);
  const double untold = mean_normalised_error(world, {.corner_bias_px = 0.0}, disturb, 5);
  EXPECT_GT(untold, 3.0) << "the case must be one that the residuals do not show";
}

TEST(MapCovarianceStatistics, KnowsErrorsThatBlocksOfFramesShare) {
  // A lens that breathes: all that a block of twenty frames sees is magnified by a factor of its own. Each
  // tag's residuals hardly show it, as the poses of frames take most of it.
  const SyntheticWorld world = test::make_room(8, 200, test::equidistant_camera());
  constexpr std::size_t kBlock = 20;
  constexpr double kSpread = 0.002;
  const double ratio = mean_normalised_error(
      world, {.corner_bias_px = 0.0, .intrinsics = Intrinsics::kKeep},
      [&](std::vector<FrameDetections>& frames, RandomStream& random) {
        const Pinhole pinhole = world.rig.cameras[0].model.pinhole();
        double magnified = 1.0;
        for (std::size_t i = 0; i < frames.size(); ++i) {
          if (i % kBlock == 0) magnified = 1.0 + kSpread * random.normal();
          for (Detection& detection : frames[i].detections) {
            for (Eigen::Vector2d& corner : detection.corners_px) {
              const Eigen::Vector2d middle(pinhole.cx, pinhole.cy);
              corner = middle + magnified * (corner - middle);
            }
          }
        }
        test::add_edge_noise(frames, 0.05, -0.45, random);
      },
      12);
  EXPECT_GT(ratio, 0.4);
  EXPECT_LT(ratio, 2.0);
}

TEST(MapCovariance, LeavesCovariancesOutOfMapsOverTheLimitAndSaysSo) {
  const SyntheticWorld world = test::make_room(10, 40, test::equidistant_camera());
  const auto frames = test::exact_detections(world);
  const auto calibrate = [&](int limit) {
    return calibrate_map(frames, world.rig, world.sizes(), {.max_tags_with_covariance = limit});
  };
  const CalibrationResult with = calibrate(10);
  const CalibrationResult without = calibrate(9);
  EXPECT_TRUE(with.warnings.empty());
  ASSERT_EQ(without.warnings.size(), 1u);
  EXPECT_NE(without.warnings[0].find("the map has 10 tags"), std::string::npos) << without.warnings[0];
  ASSERT_EQ(with.map.tags.size(), 10u);
  ASSERT_EQ(without.map.tags.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_TRUE(with.map.tags[i].covariance.has_value());
    EXPECT_FALSE(without.map.tags[i].covariance.has_value());
    EXPECT_EQ(with.map.tags[i].T_map_tag.matrix(), without.map.tags[i].T_map_tag.matrix());
    EXPECT_EQ(without.map.tags[i].statistics->flags.empty(), without.map.tags[i].statistics->views >= 5);
  }
}

/// Two tags at right angles to each other, a metre and a half away, strongly tilted: no ambiguity.
SyntheticWorld few_views_of_two_tags(int num_frames) {
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  for (const double side : {-1.0, 1.0})
    test::add_tag(world, 0.3, test::looking_along({0.35 * side, 0.0, 0.0}, {side, 1.0, 0.2 * side}));
  for (int k = 0; k < num_frames; ++k)
    world.T_world_rig.push_back(
        test::looking_along({0.2 * (k - 1), -1.5, 0.3 - 0.3 * k}, {-0.1 * (k - 1), 1.0, 0.2 * k - 0.2}));
  return world;
}

TEST(MapCovarianceStatistics, DoesNotOverclaimFromFewViews) {
  // Two frames leave 14 residuals more than unknowns: their sum alone is often half of what it should be.
  for (const int num_frames : {2, 3}) {
    const double ratio = mean_normalised_error(
        few_views_of_two_tags(num_frames), {.corner_bias_px = 0.0},
        [](auto& frames, RandomStream& random) { test::add_edge_noise(frames, 0.15, -0.45, random); }, 300);
    EXPECT_GT(ratio, 0.7) << num_frames << " frames";
    EXPECT_LT(ratio, 1.5) << num_frames << " frames";
  }
}

TEST(MapCovariance, ExactCornersLeaveACovariance) {
  // No camera gives corners without an error: a zero would say that the tag was held.
  for (const int num_frames : {2, 60}) {
    const SyntheticWorld world =
        num_frames == 2 ? few_views_of_two_tags(2) : test::make_room(14, 60, test::perspective_camera());
    const CalibrationResult result =
        calibrate_map(test::exact_detections(world), world.rig, world.sizes(), {});
    int checked = 0;
    for (const MapTag& tag : result.map.tags) {
      if (tag.key == result.held_tag) continue;
      const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(*tag.covariance);
      EXPECT_GT(solver.eigenvalues().minCoeff(), 1e-6 * 1e-6) << to_string(tag.key);
      ++checked;
    }
    EXPECT_EQ(checked + 1, static_cast<int>(world.map.tags.size()));
  }
}

}  // namespace
}  // namespace apriltrack
