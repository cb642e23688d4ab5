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
#include "initialise/part_adjustment.h"
#include "model/corner_views.h"
#include "model/view_residual.h"
#include "solve/bundle_adjustment.h"
#include "support/numeric_jacobian.h"
#include "synthetic_world.h"
#include "uncertainty/tag_covariance.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;

Observations observations_of(const SyntheticWorld& world, const std::vector<FrameDetections>& frames) {
  UnusedDetections unused;
  return collect_observations(frames, world.rig, world.sizes(), {}, unused);
}

/// The truth as a state, in the frame of the first tag.
MapState true_state(const SyntheticWorld& world, const Observations& observations) {
  MapState state;
  for (const TagKey& tag : observations.tags) state.T_map_tag.push_back(world.map.find(tag)->T_map_tag);
  state.T_map_rig = world.T_world_rig;
  state.cameras = observations.cameras;
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
    ASSERT_TRUE(view_residual(camera, size_m, view, T_map_rig, T_map_tag, &residual, &by_rig, &by_tag));
    EXPECT_LT(residual.norm(), 1e-9);  // the truth explains the corners
    const auto residual_at = [&](const Eigen::VectorXd& rig, const Eigen::VectorXd& tag) -> Eigen::VectorXd {
      Vector8d r;
      EXPECT_TRUE(view_residual(camera, size_m, view, T_map_rig * Pose::exp(Vector6d(rig)),
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

TEST(EdgeNoise, InwardDisplacementsAreThoseOfASmallerSquare) {
  // Bottom-left, bottom-right, top-right, top-left; y down. All edges of a square of 100 px move in by
  // one: 98.
  const CornersPx square = {Eigen::Vector2d(10, 110), {110, 110}, {110, 10}, {10, 10}};
  Vector8d expected;
  expected << 1, -1, -1, -1, -1, 1, 1, 1;
  EXPECT_LT((inward_displacements(square) - expected).norm(), 1e-12);
}

TEST(EdgeNoise, InwardDisplacementsMoveEachEdgeOfAnyQuadByOne) {
  const CornersPx corners = {Eigen::Vector2d(100, 210), {190, 230}, {205, 120}, {90, 100}};
  const Vector8d displacements = inward_displacements(corners);
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const std::size_t end = (edge + 1) % 4;
    const Eigen::Vector2d along = (corners[end] - corners[edge]).normalized();
    Eigen::Vector2d normal(-along.y(), along.x());
    if (normal.dot(middle - corners[edge]) < 0.0) normal = -normal;
    EXPECT_NEAR(normal.dot(displacements.segment<2>(2 * static_cast<Eigen::Index>(edge))), 1.0, 1e-12);
    EXPECT_NEAR(normal.dot(displacements.segment<2>(2 * static_cast<Eigen::Index>(end))), 1.0, 1e-12);
  }
}

TEST(TagCovariance, AgreesWithCeres) {
  const SyntheticWorld world = test::make_room(7, 16, test::equidistant_camera());
  const Observations observations = observations_of(world, test::exact_detections(world));
  const MapState state = true_state(world, observations);
  Connectivity connectivity = find_parts(observations, all_views(observations), 2);
  ASSERT_EQ(connectivity.parts.size(), 1u);
  const Part& part = connectivity.parts[0];
  ASSERT_EQ(part.tags.size(), 7u);
  const auto views = corner_views(observations, part.views, state);
  const auto poses = PoseInformation::of(views, part.tags, 0);
  ASSERT_TRUE(poses.has_value());
  const auto own = tag_covariances(*poses, part.tags);
  EXPECT_EQ(own[0].by_noise, Matrix6d::Zero());
  EXPECT_EQ(own[0].by_bias, Matrix6d::Zero());

  BundleProblem problem(observations, part.views, {1, 2, 3, 4, 5, 6}, state, 0.0);
  ceres::Covariance covariance((ceres::Covariance::Options()));
  std::vector<std::pair<const double*, const double*>> blocks;
  for (int tag = 1; tag < 7; ++tag) blocks.emplace_back(problem.tag_block(tag), problem.tag_block(tag));
  ASSERT_TRUE(covariance.Compute(blocks, &problem.problem()));
  for (int tag = 1; tag < 7; ++tag) {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> expected;
    ASSERT_TRUE(covariance.GetCovarianceBlockInTangentSpace(problem.tag_block(tag), problem.tag_block(tag),
                                                            expected.data()));
    const Matrix6d& actual = own[static_cast<std::size_t>(tag)].by_noise;
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
  const auto views = corner_views(observations, part.views, state);
  const auto poses = PoseInformation::of(views, part.tags, kHeld);
  ASSERT_TRUE(poses.has_value());
  const auto own = tag_covariances(*poses, part.tags);

  const auto num_frames = static_cast<Eigen::Index>(state.T_map_rig.size());
  const auto num_rows = 8 * static_cast<Eigen::Index>(part.views.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(num_rows, 6 * (num_tags + num_frames));
  Eigen::MatrixXd errors_of_tags = Eigen::MatrixXd::Zero(num_rows, 8 * num_tags);
  for (std::size_t i = 0; i < part.views.size(); ++i) {
    const TagView& view = observations.views[part.views[i]];
    Vector8d residual;
    Matrix8x6d by_rig, by_tag;
    ASSERT_TRUE(
        view_residual(observations.cameras[0], observations.sizes_m[static_cast<std::size_t>(view.tag)], view,
                      state.T_map_rig[static_cast<std::size_t>(view.frame)],
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
    const TagCovariance& actual = own[static_cast<std::size_t>(tag)];
    EXPECT_LE((actual.by_noise - noise).norm(), 1e-6 * noise.norm()) << "tag " << tag;
    EXPECT_LE((actual.by_bias - bias).norm(), 1e-6 * bias.norm()) << "tag " << tag;
    EXPECT_EQ(noise.norm() > 0.0, tag != kHeld);
  }
}

/// By which all poses move alike.
SharedErrors alike(const PoseInformation& poses, Eigen::Index num, double follow, double variance) {
  ParameterInformation information;
  information.poses_by_parameter = Eigen::MatrixXd::Constant(poses.size(), num, follow);
  return {information, variance};
}

TEST(TagCovariance, AddsErrorsThatAreIndependentOfEachOther) {
  const SyntheticWorld world = test::make_room(6, 30, test::perspective_camera());
  const Observations observations = observations_of(world, test::exact_detections(world));
  const std::vector<LinearView> views =
      corner_views(observations, all_views(observations), true_state(world, observations));
  const std::vector<int> tags = {0, 1, 2, 3, 4, 5};
  const auto poses = PoseInformation::of(views, tags, 0);
  ASSERT_TRUE(poses);
  SharedErrors a = alike(*poses, 2, 0.3, 4.0);
  a.parameters_by_errors[1] = Eigen::MatrixXd::Constant(2, 8, 0.2);
  const SharedErrors b = alike(*poses, 1, 0.7, 0.5);
  const auto none = tag_covariances(*poses, tags), of_a = tag_covariances(*poses, tags, a),
             of_b = tag_covariances(*poses, tags, b);
  for (const SharedErrors& both : {together(a, b), together(b, a)}) {
    const auto sum = tag_covariances(*poses, tags, both);
    for (std::size_t i = 1; i < tags.size(); ++i) {
      const Matrix6d expected = of_a[i].by_noise + of_b[i].by_noise - none[i].by_noise;
      EXPECT_LT((sum[i].by_noise - expected).norm(), 1e-9 * expected.norm());
      EXPECT_LT((sum[i].by_bias - of_a[i].by_bias).norm(), 1e-9 * of_a[i].by_bias.norm());
    }
  }
}

TEST(TagCovariance, IsRefusedWhenATagHangsInTheAir) {
  const SyntheticWorld world = test::make_room(7, 16, test::equidistant_camera());
  const Observations observations = observations_of(world, test::exact_detections(world));
  Connectivity connectivity = find_parts(observations, all_views(observations), 2);
  Part part = connectivity.parts[0];
  std::erase_if(part.views, [&](std::size_t v) { return observations.views[v].tag == 3; });
  const auto views = corner_views(observations, part.views, true_state(world, observations));
  EXPECT_FALSE(PoseInformation::of(views, part.tags, 0).has_value());
}

TEST(AdjustPart, SaysThatTheFirstAdjustmentFailed) {
  const SyntheticWorld world = test::make_room(7, 16, test::equidistant_camera());
  Observations observations = observations_of(world, test::exact_detections(world));
  const Connectivity connectivity = find_parts(observations, all_views(observations), 2);
  ASSERT_EQ(connectivity.parts.size(), 1u);
  const ParallelFor parallel = parallel_for(1);
  const auto candidates = solve_views(observations, all_views(observations), parallel);
  // A residual that is no number stops the solver before its first step.
  observations.views[3].whitening.setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto adjusted = adjust_part({observations, candidates, {}}, connectivity.parts[0], 0, parallel);
  ASSERT_FALSE(adjusted) << "an adjustment that failed must not go on";
  EXPECT_NE(adjusted.why().cause.find("robust adjustment"), std::string::npos) << adjusted.why().cause;
}

}  // namespace
}  // namespace apriltrack
