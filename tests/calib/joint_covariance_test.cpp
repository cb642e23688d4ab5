// Covariances between tags, against equations written out in full and against other gauges.
#include "apriltrack/calib/joint_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <numeric>

#include "calibrating.h"
#include "model/corner_views.h"
#include "observations/parts.h"
#include "support/shared_data.h"
#include "uncertainty/joint_tag_covariance.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;

struct LinearWorld {
  LinearWorld() : world(test::make_room(7, 16, test::equidistant_camera())) {
    UnusedDetections unused;
    observations = collect_observations(test::exact_detections(world), world.rig, world.sizes(), {}, unused);
    for (const TagKey& tag : observations.tags) state.T_map_tag.push_back(world.map.find(tag)->T_map_tag);
    state.T_map_rig = world.T_world_rig;
    state.cameras = observations.cameras;
    std::vector<std::size_t> all(observations.views.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    part = find_parts(observations, all, 2).parts.at(0);
    views = corner_views(observations, part.views, state);
  }

  JointCovariance joint_with(int held_tag, const ErrorScale& scale) const {
    return joint_tag_covariance(*PoseInformation::of(views, part.tags, held_tag), part.tags,
                                observations.tags, scale);
  }

  SyntheticWorld world;
  Observations observations;
  MapState state;
  Part part;
  std::vector<LinearView> views;
};

constexpr ErrorScale kScale{.noise_variance = 2.5, .bias_variance = 0.09, .views_per_independent_view = 1.25};

/// The Jacobian of log(T_a_b^-1 T_a_b') by the perturbations of both poses, by central differences.
Eigen::Matrix<double, 6, 12> relative_by_both(const Pose& T_map_a, const Pose& T_map_b) {
  constexpr double kStep = 1e-6;
  const Pose T_b_a = T_map_b.inverse() * T_map_a;
  Eigen::Matrix<double, 6, 12> by_both;
  for (int i = 0; i < 12; ++i) {
    const auto at = [&](double step) {
      Vector6d a = Vector6d::Zero(), b = Vector6d::Zero();
      (i < 6 ? a : b)[i % 6] = step;
      return (T_b_a * ((T_map_a * Pose::exp(a)).inverse() * (T_map_b * Pose::exp(b)))).log();
    };
    by_both.col(i) = (at(kStep) - at(-kStep)) / (2.0 * kStep);
  }
  return by_both;
}

TEST(JointCovariance, OfTwoTagsIsThatOfAllEquationsWrittenOut) {
  const LinearWorld linear;
  ASSERT_EQ(linear.part.tags.size(), 7u);
  constexpr int kHeld = 2;
  const JointCovariance joint = linear.joint_with(kHeld, kScale);

  // Nothing eliminated, nothing scaled; the held tag's columns are zero.
  const Eigen::Index num_tags = 7, num_frames = static_cast<Eigen::Index>(linear.state.T_map_rig.size());
  const auto num_rows = 8 * static_cast<Eigen::Index>(linear.views.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(num_rows, 6 * (num_tags + num_frames));
  Eigen::MatrixXd errors = Eigen::MatrixXd::Zero(num_rows, 8 * num_tags);
  for (std::size_t i = 0; i < linear.views.size(); ++i) {
    const LinearView& view = linear.views[i];
    const auto row = 8 * static_cast<Eigen::Index>(i);
    if (view.tag != kHeld) J.block(row, 6 * view.tag, 8, 6) = view.by_tag;
    J.block(row, 6 * (num_tags + view.frame), 8, 6) = view.by_rig;
    errors.block(row, 8 * view.tag, 8, 8) = view.by_error;
  }
  const Eigen::MatrixXd inverse = J.completeOrthogonalDecomposition().pseudoInverse().topRows(6 * num_tags);
  const Eigen::MatrixXd by_bias = inverse * errors;
  const Eigen::MatrixXd expected_all = kScale.noise_variance * inverse * inverse.transpose() +
                                       kScale.bias_variance * by_bias * by_bias.transpose();
  EXPECT_LT((joint.matrix() - expected_all).norm(), 1e-6 * expected_all.norm());

  TagMap map = linear.world.map;
  for (int a = 0; a < 7; ++a) {
    for (int b = 0; b < 7; ++b) {
      if (a == b) continue;
      const auto ta = static_cast<std::size_t>(a), tb = static_cast<std::size_t>(b);
      Eigen::Matrix<double, 12, 12> both;
      both << expected_all.block<6, 6>(6 * a, 6 * a), expected_all.block<6, 6>(6 * a, 6 * b),
          expected_all.block<6, 6>(6 * b, 6 * a), expected_all.block<6, 6>(6 * b, 6 * b);
      const auto by_both = relative_by_both(linear.state.T_map_tag[ta], linear.state.T_map_tag[tb]);
      const Matrix6d expected = by_both * both * by_both.transpose();
      const auto actual =
          relative_covariance(map, joint, linear.observations.tags[ta], linear.observations.tags[tb]);
      ASSERT_TRUE(actual.has_value());
      EXPECT_LT((*actual - expected).norm(), 1e-5 * expected.norm()) << a << " " << b;
    }
  }
}

TEST(JointCovariance, OfTwoTagsDoesNotDependOnTheHeldOne) {
  const LinearWorld linear;
  const JointCovariance first = linear.joint_with(0, kScale), second = linear.joint_with(5, kScale);
  EXPECT_EQ(first.block(0, 0), Matrix6d::Zero());
  EXPECT_GT(second.block(0, 0).norm(), 0.0);
  for (const TagKey& a : linear.observations.tags) {
    for (const TagKey& b : linear.observations.tags) {
      const Matrix6d one = *relative_covariance(linear.world.map, first, a, b);
      const Matrix6d other = *relative_covariance(linear.world.map, second, a, b);
      if (a == b)
        EXPECT_LT(one.norm(), 1e-15);
      else
        EXPECT_LT((one - other).norm(), 1e-6 * one.norm()) << to_string(a) << " " << to_string(b);
    }
  }
}

TEST(JointCovariance, OfACalibrationHoldsThatOfEachTagAndKnowsOfItsCamera) {
  const SyntheticWorld world = test::make_room(14, 120, test::perspective_camera());
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(17);
  test::add_edge_noise(frames, 0.05, -0.45, random);
  for (FrameDetections& frame : frames) {  // edges that lie inside the true ones: estimated with the map
    for (Detection& detection : frame.detections) {
      const Vector8d inward = inward_displacements(detection.corners_px);
      for (int corner = 0; corner < 4; ++corner)
        detection.corners_px[static_cast<std::size_t>(corner)] += 0.2 * inward.segment<2>(2 * corner);
    }
  }
  std::vector<Matrix6d> relative;
  for (const int held : {3, 7}) {
    const CalibrationResult result = test::calibrate(
        world, frames,
        {.held_tag = test::tag36h11(held), .edge_offset_sigma_px = 0.2, .intrinsics = Intrinsics::kKeep});
    ASSERT_FALSE(result.corrections.empty());
    const JointCovariance& joint = result.evidence.joint;
    ASSERT_EQ(joint.tags.size(), 14u);
    for (const MapTag& tag : result.map.tags) {
      const Eigen::Index row = *joint.row_of(tag.key);
      EXPECT_LE((joint.block(row, row) - *tag.covariance).norm(), 1e-9 * tag.covariance->norm());
    }
    relative.push_back(*relative_covariance(result.map, joint, test::tag36h11(5), test::tag36h11(13)));
  }
  // Two adjustments, which end where they end.
  EXPECT_LT((relative[0] - relative[1]).norm(), 1e-2 * relative[0].norm());
}

TEST(JointCovariance, IsLeftOutOfLargeMaps) {
  const SyntheticWorld world = test::make_room(8, 30, test::equidistant_camera());
  const CalibrationResult result =
      test::calibrate(world, test::exact_detections(world), {.max_tags_with_joint_covariance = 7});
  EXPECT_TRUE(result.evidence.joint.is_empty());
  EXPECT_TRUE(result.map.tags[1].covariance.has_value());
  EXPECT_FALSE(relative_covariance(result.map, result.evidence.joint, test::tag36h11(3), test::tag36h11(5)));
}

}  // namespace
}  // namespace apriltrack
