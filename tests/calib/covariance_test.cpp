#include <ceres/covariance.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>
#include <map>
#include <numeric>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/geometry/rotation.h"
#include "bundle_adjustment.h"
#include "part_solver.h"
#include "support/numeric_jacobian.h"
#include "synthetic_world.h"
#include "tag_covariance.h"
#include "view_residual.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;

Observations observations_of(const SyntheticWorld& world, const std::vector<FrameDetections>& frames) {
  Findings findings;
  return collect_observations(frames, world.rig, world.sizes(), {}, findings);
}

/// The truth as a state, in the frame of the first tag.
MapState true_state(const SyntheticWorld& world, const Observations& observations) {
  MapState state;
  for (const TagKey& tag : observations.tags) state.T_map_tag.push_back(world.map.find(tag)->T_map_tag);
  state.T_map_rig = world.T_world_rig;
  move_origin_to(state, 0);
  return state;
}

std::vector<std::size_t> all_views(const Observations& observations) {
  std::vector<std::size_t> views(observations.views.size());
  std::iota(views.begin(), views.end(), std::size_t{0});
  return views;
}

TEST(ViewResidual, JacobiansAgreeWithDifferences) {
  SyntheticWorld world = test::make_room(8, 12, test::equidistant_camera());
  Camera second = test::perspective_camera("cam1");
  second.T_this_previous = Pose(rotation_exp({0.3, -0.4, 0.1}), Eigen::Vector3d(0.2, 0.1, -0.3));
  world.rig.cameras.push_back(second);
  const Observations observations = observations_of(world, test::exact_detections(world));
  const MapState state = true_state(world, observations);
  int checked = 0, of_second_camera = 0;
  for (std::size_t v = 0; v < observations.views.size(); v += 3) {
    const TagView& view = observations.views[v];
    const RigCamera& camera = observations.cameras[static_cast<std::size_t>(view.camera)];
    const double size_m = observations.sizes_m[static_cast<std::size_t>(view.tag)];
    const Pose& T_map_rig = state.T_map_rig[static_cast<std::size_t>(view.frame)];
    const Pose& T_map_tag = state.T_map_tag[static_cast<std::size_t>(view.tag)];
    Vector8d residual;
    Matrix8x6d by_rig, by_tag;
    ASSERT_TRUE(
        view_residual(camera, size_m, view.corners_px, T_map_rig, T_map_tag, &residual, &by_rig, &by_tag));
    EXPECT_LT(residual.norm(), 1e-9);  // the truth explains the corners
    const auto residual_at = [&](const Eigen::VectorXd& rig, const Eigen::VectorXd& tag) -> Eigen::VectorXd {
      Vector8d r;
      EXPECT_TRUE(view_residual(camera, size_m, view.corners_px, T_map_rig * Pose::exp(Vector6d(rig)),
                                T_map_tag * Pose::exp(Vector6d(tag)), &r, nullptr, nullptr));
      return r;
    };
    const Vector6d none = Vector6d::Zero();
    EXPECT_TRUE(test::jacobians_agree(
        by_rig, test::numeric_jacobian([&](const Eigen::VectorXd& xi) { return residual_at(xi, none); }, 6),
        1e-6));
    EXPECT_TRUE(test::jacobians_agree(
        by_tag, test::numeric_jacobian([&](const Eigen::VectorXd& xi) { return residual_at(none, xi); }, 6),
        1e-6));
    ++checked;
    if (view.camera == 1) ++of_second_camera;
  }
  EXPECT_GE(checked, 10);
  EXPECT_GE(of_second_camera, 3);
}

TEST(EdgeNoise, WhiteningGivesUnitCovariance) {
  // The closed form against sampled errors of that very model, drawn by the tests' own code.
  FrameDetections frame;
  frame.detections.resize(1);
  const CornersPx corners = {Eigen::Vector2d(100, 210), {190, 230}, {205, 120}, {90, 100}};
  const EdgeNoise noise{.sigma_px = 0.2, .end_correlation = -0.45};
  const Matrix8d W = edge_noise_whitening(corners, noise);
  RandomStream random(3);
  constexpr int kSamples = 40000;
  Matrix8d sum = Matrix8d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    frame.detections[0].corners_px = corners;
    std::vector<FrameDetections> frames = {frame};
    test::add_edge_noise(frames, noise.sigma_px, noise.end_correlation, random);
    Vector8d error;
    for (int c = 0; c < 4; ++c) {
      const auto corner = static_cast<std::size_t>(c);
      error.segment<2>(2 * c) = frames[0].detections[0].corners_px[corner] - corners[corner];
    }
    const Vector8d whitened = W * error;
    sum += whitened * whitened.transpose();
  }
  // Five standard deviations of a sampled variance, sqrt(2 / n).
  EXPECT_LT((sum / kSamples - Matrix8d::Identity()).cwiseAbs().maxCoeff(), 5.0 * std::sqrt(2.0 / kSamples));
}

TEST(TagCovariance, AgreesWithCeres) {
  const SyntheticWorld world = test::make_room(7, 16, test::equidistant_camera());
  const Observations observations = observations_of(world, test::exact_detections(world));
  const MapState state = true_state(world, observations);
  Connectivity connectivity = find_parts(observations, all_views(observations), 2);
  ASSERT_EQ(connectivity.parts.size(), 1u);
  const Part& part = connectivity.parts[0];
  ASSERT_EQ(part.tags.size(), 7u);
  const auto own = tag_covariances(observations, part, 0, state);
  ASSERT_TRUE(own.has_value());
  EXPECT_EQ((*own)[0].by_noise, Matrix6d::Zero());
  EXPECT_EQ((*own)[0].by_bias, Matrix6d::Zero());

  BundleProblem problem(observations, part.views, {1, 2, 3, 4, 5, 6}, state, 0.0);
  ceres::Covariance covariance((ceres::Covariance::Options()));
  std::vector<std::pair<const double*, const double*>> blocks;
  for (int tag = 1; tag < 7; ++tag) blocks.emplace_back(problem.tag_block(tag), problem.tag_block(tag));
  ASSERT_TRUE(covariance.Compute(blocks, &problem.problem()));
  for (int tag = 1; tag < 7; ++tag) {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> expected;
    ASSERT_TRUE(covariance.GetCovarianceBlockInTangentSpace(problem.tag_block(tag), problem.tag_block(tag),
                                                            expected.data()));
    const Matrix6d& actual = (*own)[static_cast<std::size_t>(tag)].by_noise;
    EXPECT_LT((actual - expected).norm(), 1e-6 * expected.norm()) << actual << "\n\n" << expected;
  }
}

TEST(TagCovariance, AgreesWithThePseudoinverseOfAllEquations) {
  // More tags than are solved at once, and the equations written out in full: nothing eliminated, nothing
  // scaled.
  const SyntheticWorld world = test::make_room(24, 40, test::equidistant_camera());
  const Observations observations = observations_of(world, test::exact_detections(world));
  const MapState state = true_state(world, observations);
  const Connectivity connectivity = find_parts(observations, all_views(observations), 2);
  ASSERT_EQ(connectivity.parts.size(), 1u);
  const Part& part = connectivity.parts[0];
  const auto num_tags = static_cast<Eigen::Index>(part.tags.size());
  ASSERT_GT(num_tags, 17);
  constexpr int kHeld = 2;
  const auto own = tag_covariances(observations, part, kHeld, state);
  ASSERT_TRUE(own.has_value());

  const auto num_frames = static_cast<Eigen::Index>(state.T_map_rig.size());
  const auto num_rows = 8 * static_cast<Eigen::Index>(part.views.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(num_rows, 6 * (num_tags + num_frames));
  Eigen::MatrixXd errors_of_tags = Eigen::MatrixXd::Zero(num_rows, 8 * num_tags);
  for (std::size_t i = 0; i < part.views.size(); ++i) {
    const TagView& view = observations.views[part.views[i]];
    Vector8d residual;
    Matrix8x6d by_rig, by_tag;
    ASSERT_TRUE(
        view_residual(observations.cameras[0], observations.sizes_m[static_cast<std::size_t>(view.tag)],
                      view.corners_px, state.T_map_rig[static_cast<std::size_t>(view.frame)],
                      state.T_map_tag[static_cast<std::size_t>(view.tag)], &residual, &by_rig, &by_tag));
    const auto row = 8 * static_cast<Eigen::Index>(i);
    if (view.tag != kHeld) J.block<8, 6>(row, 6 * view.tag) = view.whitening * by_tag;
    J.block<8, 6>(row, 6 * (num_tags + view.frame)) = view.whitening * by_rig;
    errors_of_tags.block<8, 8>(row, 8 * view.tag).setIdentity();
  }
  // The held tag's columns, and those of frames without views, are zero, and so are their rows here.
  const Eigen::MatrixXd d_unknown_d_error = J.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd d_unknown_d_bias = d_unknown_d_error * errors_of_tags;
  for (Eigen::Index tag = 0; tag < num_tags; ++tag) {
    const auto by_error = d_unknown_d_error.middleRows<6>(6 * tag);
    const auto by_bias = d_unknown_d_bias.middleRows<6>(6 * tag);
    const Matrix6d noise = by_error * by_error.transpose();
    const Matrix6d bias = by_bias * by_bias.transpose();
    const TagCovariance& actual = (*own)[static_cast<std::size_t>(tag)];
    EXPECT_LE((actual.by_noise - noise).norm(), 1e-6 * noise.norm()) << "tag " << tag;
    EXPECT_LE((actual.by_bias - bias).norm(), 1e-6 * bias.norm()) << "tag " << tag;
    EXPECT_EQ(noise.norm() > 0.0, tag != kHeld);
  }
}

TEST(TagCovariance, IsRefusedWhenATagHangsInTheAir) {
  const SyntheticWorld world = test::make_room(7, 16, test::equidistant_camera());
  const Observations observations = observations_of(world, test::exact_detections(world));
  Connectivity connectivity = find_parts(observations, all_views(observations), 2);
  Part part = connectivity.parts[0];
  std::erase_if(part.views, [&](std::size_t v) { return observations.views[v].tag == 3; });
  EXPECT_FALSE(tag_covariances(observations, part, 0, true_state(world, observations)).has_value());
}

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
      const Pose truth = test::T_origin_tag(world.map, result.held_tag, tag.key);
      const Vector6d xi = (tag.T_map_tag.inverse() * truth).log();
      sum += xi.dot(tag.covariance->ldlt().solve(xi)) / 6.0;
      ++count;
    }
  }
  EXPECT_GT(count, 0);
  return sum / count;
}

TEST(CalibrateMap, ErrorsAreAsLargeAsTheCovarianceSays) {
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

TEST(CalibrateMap, CovarianceStaysUsefulWhenCornersErrIndependently) {
  // Not the detector's noise, but what corners from elsewhere may have: off by no more than the model's
  // mismatch.
  const SyntheticWorld world = test::make_room(10, 40, test::equidistant_camera());
  const double ratio = mean_normalised_error(
      world, {.edge_end_correlation = 0.0, .corner_bias_px = 0.0},
      [](auto& frames, RandomStream& random) { test::add_noise(frames, 0.15, random); }, 30);
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.25);
}

TEST(CalibrateMap, CovarianceKnowsThatNeighbouringFramesRepeatTheirErrors) {
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

TEST(CalibrateMap, CovarianceKnowsErrorsThatATagKeepsInAllItsViews) {
  // Constant normal errors at the ends of each tag's edges, under larger ones that are new in every view: too
  // small a share to be seen in the residuals, and all that is left in a long film.
  const SyntheticWorld world = test::make_room(8, 240, test::equidistant_camera());
  constexpr double kBias_px = 0.05;
  const auto disturb = [&](std::vector<FrameDetections>& frames, RandomStream& random) {
    std::map<TagKey, std::array<Eigen::Vector2d, 4>> ends;  // of each edge: error at its begin, at its end
    const double rho = -0.45;
    for (FrameDetections& frame : frames) {
      for (Detection& detection : frame.detections) {
        const auto [entry, is_new] = ends.try_emplace(detection.tag);
        if (is_new) {
          for (Eigen::Vector2d& edge : entry->second) {
            const double begin = random.normal();
            edge =
                kBias_px * Eigen::Vector2d(begin, rho * begin + std::sqrt(1.0 - rho * rho) * random.normal());
          }
        }
        const CornersPx exact = detection.corners_px;
        std::array<Eigen::Vector2d, 4> normals;
        for (std::size_t e = 0; e < 4; ++e) {
          const Eigen::Vector2d along = (exact[(e + 1) % 4] - exact[e]).normalized();
          normals[e] = {-along.y(), along.x()};
        }
        for (std::size_t c = 0; c < 4; ++c) {
          // The corner lies on the lines of the edge that begins in it and of the one that ends in it.
          const std::size_t before = (c + 3) % 4;
          Eigen::Matrix2d lines;
          lines << normals[c].transpose(), normals[before].transpose();
          detection.corners_px[c] +=
              lines.inverse() * Eigen::Vector2d(entry->second[c][0], entry->second[before][1]);
        }
      }
    }
    test::add_edge_noise(frames, 0.15, rho, random);
  };
  const double told = mean_normalised_error(world, {.corner_bias_px = kBias_px}, disturb, 20);
  EXPECT_GT(told, 0.8);
  EXPECT_LT(told, 1.25);
  const double untold = mean_normalised_error(world, {.corner_bias_px = 0.0}, disturb, 5);
  EXPECT_GT(untold, 3.0) << "the case must be one that the residuals do not show";
}

TEST(CalibrateMap, LeavesCovariancesOutOfMapsOverTheLimitAndSaysSo) {
  const SyntheticWorld world = test::make_room(10, 40, test::equidistant_camera());
  const auto frames = test::exact_detections(world);
  const auto calibrate = [&](int limit) {
    return calibrate_map(frames, world.rig, world.sizes(), {.max_tags_with_covariance = limit});
  };
  const CalibrationResult with = calibrate(10);
  const CalibrationResult without = calibrate(9);
  EXPECT_TRUE(with.warnings.empty());
  ASSERT_EQ(without.warnings.size(), 1u);
  EXPECT_NE(without.warnings[0].find("no covariances: the map has 10 tags"), std::string::npos)
      << without.warnings[0];
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
  for (int i = 0; i < 2; ++i) {
    MapTag tag;
    tag.key.id = i;
    tag.size_m = 0.3;
    const double side = i == 0 ? -1.0 : 1.0;
    tag.T_map_tag = test::looking_along({0.35 * side, 0.0, 0.0}, {side, 1.0, 0.2 * side});
    world.map.tags.push_back(tag);
  }
  for (int k = 0; k < num_frames; ++k)
    world.T_world_rig.push_back(
        test::looking_along({0.2 * (k - 1), -1.5, 0.3 - 0.3 * k}, {-0.1 * (k - 1), 1.0, 0.2 * k - 0.2}));
  return world;
}

TEST(CalibrateMap, CovarianceDoesNotOverclaimFromFewViews) {
  // Two frames leave 14 residuals more than unknowns: their sum alone is often half of what it should be.
  for (const int num_frames : {2, 3}) {
    const double ratio = mean_normalised_error(
        few_views_of_two_tags(num_frames), {.corner_bias_px = 0.0},
        [](auto& frames, RandomStream& random) { test::add_edge_noise(frames, 0.15, -0.45, random); }, 300);
    EXPECT_GT(ratio, 0.7) << num_frames << " frames";
    EXPECT_LT(ratio, 1.5) << num_frames << " frames";
  }
}

TEST(CalibrateMap, ExactCornersLeaveACovariance) {
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

TEST(SolvePart, SaysThatTheFirstAdjustmentFailed) {
  const SyntheticWorld world = test::make_room(7, 16, test::equidistant_camera());
  Observations observations = observations_of(world, test::exact_detections(world));
  const Connectivity connectivity = find_parts(observations, all_views(observations), 2);
  ASSERT_EQ(connectivity.parts.size(), 1u);
  const ParallelFor parallel = parallel_for(1);
  const auto candidates = solve_views(observations, all_views(observations), parallel);
  // A residual that is no number stops the solver before its first step.
  observations.views[3].whitening.setConstant(std::numeric_limits<double>::quiet_NaN());
  try {
    solve_part(observations, connectivity.parts[0], 0, candidates, {}, parallel, silent_log());
    FAIL() << "an adjustment that failed must not go on";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kNoResult);
    EXPECT_NE(std::string(error.what()).find("robust adjustment"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace apriltrack
