#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/tracker/localizer.h"
#include "pose_adjustment.h"
#include "pose_candidate.h"
#include "support/numeric_jacobian.h"
#include "synthetic_world.h"

namespace apriltrack {
namespace {

constexpr int kFrames = 400;

/// Corners that move together along one direction by ten times as much as they do otherwise.
CornerCovariance lopsided_corners(double sigma_px, double angle_rad) {
  Eigen::Matrix<double, 8, 1> together;
  together << std::cos(angle_rad), std::sin(angle_rad), std::cos(angle_rad), std::sin(angle_rad),
      std::cos(angle_rad), -std::sin(angle_rad), 0.3, -0.5;
  together.normalize();
  return sigma_px * sigma_px * (8.0 * together * together.transpose() + 0.08 * CornerCovariance::Identity());
}

/// The even tags of the room as sharp as a good detector has them, the odd ones many times as noisy; each
/// with its covariance.
FrameDetections with_covariances(FrameDetections frame) {
  for (Detection& detection : frame.detections) {
    const int id = detection.tag.id;
    detection.covariance_px2 = lopsided_corners(id % 2 == 0 ? 0.1 : 4.0, 0.7 * id);
  }
  return frame;
}

/// Corners with errors drawn from the detections' covariances.
FrameDetections drawn_from_covariances(FrameDetections frame, RandomStream& random) {
  for (Detection& detection : frame.detections) {
    Eigen::Matrix<double, 8, 1> normal;
    for (double& value : normal) value = random.normal();
    const Eigen::Matrix<double, 8, 1> errors_px = detection.covariance_px2->llt().matrixL() * normal;
    for (std::size_t i = 0; i < 4; ++i)
      detection.corners_px[i] += errors_px.segment<2>(2 * static_cast<Eigen::Index>(i));
  }
  return frame;
}

Eigen::VectorXd stacked(const FrameDetections& frame) {
  Eigen::VectorXd pixels(8 * static_cast<Eigen::Index>(frame.detections.size()));
  Eigen::Index row = 0;
  for (const Detection& detection : frame.detections)
    for (const Eigen::Vector2d& corner : detection.corners_px) pixels.segment<2>(2 * row++) = corner;
  return pixels;
}

/// The pose of generalised least squares, from the truth, by numeric derivatives of the definition of a view.
Pose optimum(const Camera& camera, const TagMap& map, const FrameDetections& noisy, Pose T_camera_map) {
  const auto n = 8 * static_cast<Eigen::Index>(noisy.detections.size());
  Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; i += 8)
    weight.block<8, 8>(i, i) = noisy.detections[static_cast<std::size_t>(i / 8)].covariance_px2->inverse();
  for (int step = 0; step < 5; ++step) {
    const auto pixels = [&](const Eigen::VectorXd& xi) {
      return stacked(test::seen(camera, map, T_camera_map * Pose::exp(xi)));
    };
    const Eigen::MatrixXd J = test::numeric_jacobian(pixels, 6);
    const Eigen::VectorXd error = pixels(Eigen::VectorXd::Zero(6)) - stacked(noisy);
    const Vector6d down = (J.transpose() * weight * J).ldlt().solve(J.transpose() * weight * error);
    T_camera_map = T_camera_map * Pose::exp(-down);
  }
  return T_camera_map;
}

struct LocalizerErrors {
  double rms_m = 0.0, rms_of_optimum_m = 0.0;
  double nees_over_6 = 0.0;  ///< Mean.
  int contradicting = 0;     ///< Tags, in all frames.
};

LocalizerErrors localise_noisy_views(TrackMode mode, bool with_told_covariances) {
  const Camera camera = test::radtan();
  const TagMap map = test::room();
  RandomStream random(611);
  LocalizerErrors errors;
  LocalizerOptions options;
  options.mode = mode;
  for (int i = 0; i < kFrames; ++i) {
    const Pose T_camera_map = test::random_T_map_camera(random).inverse();
    FrameDetections noisy =
        drawn_from_covariances(with_covariances(test::seen(camera, map, T_camera_map)), random);
    const Pose best = optimum(camera, map, noisy, T_camera_map);
    if (!with_told_covariances)
      for (Detection& detection : noisy.detections) detection.covariance_px2.reset();
    const TrackResult result = Localizer(camera, map, options).localize(noisy);
    if (!result.pose) {
      ADD_FAILURE() << "frame " << i << ": " << result.reason;
      continue;
    }
    const auto of_mode = [&](const Pose& T) { return mode == TrackMode::kEgo ? T.inverse() : T; };
    const Vector6d xi = (result.pose->inverse() * of_mode(T_camera_map)).log();
    const Vector6d xi_of_best = (of_mode(best).inverse() * of_mode(T_camera_map)).log();
    errors.rms_m += xi.head<3>().squaredNorm() / kFrames;
    errors.rms_of_optimum_m += xi_of_best.head<3>().squaredNorm() / kFrames;
    errors.nees_over_6 += xi.dot(result.covariance->llt().solve(xi)) / 6.0 / kFrames;
    errors.contradicting += static_cast<int>(result.contradicting_tags.size());
  }
  errors.rms_m = std::sqrt(errors.rms_m);
  errors.rms_of_optimum_m = std::sqrt(errors.rms_of_optimum_m);
  return errors;
}

class CornerCovarianceOfLocalizer : public testing::TestWithParam<TrackMode> {};
INSTANTIATE_TEST_SUITE_P(Modes, CornerCovarianceOfLocalizer,
                         testing::Values(TrackMode::kEgo, TrackMode::kJoint),
                         [](const auto& mode) { return mode.param == TrackMode::kEgo ? "Ego" : "Joint"; });

TEST_P(CornerCovarianceOfLocalizer, WeighsCornersAsTheOptimumDoesAndAccusesNone) {
  const LocalizerErrors errors = localise_noisy_views(GetParam(), true);
  EXPECT_LT(errors.rms_m, 1.1 * errors.rms_of_optimum_m);
  EXPECT_GT(errors.nees_over_6, 0.7);
  EXPECT_LT(errors.nees_over_6, 1.4);
  EXPECT_EQ(errors.contradicting, 0) << "all are where the map has them";
}

/// So that the test above can fail: what they are worth where nobody gives covariances.
TEST(CornerCovarianceOfLocalizerTest, IsWorthAFactorInThatTest) {
  const LocalizerErrors errors = localise_noisy_views(TrackMode::kEgo, false);
  EXPECT_GT(errors.rms_m, 2.0 * errors.rms_of_optimum_m);
  EXPECT_GT(errors.contradicting, kFrames / 2);
}

/// Two tags are as far off as noisy ones usually are: only the one that is known better was moved.
TEST(CornerCovarianceOfLocalizerTest, AccusesASharpTagThatIsOffByWhatIsUsualOfOthers) {
  const Camera camera = test::radtan();
  const TagMap map = test::room();
  FrameDetections frame = test::seen(camera, map, Pose());
  for (Detection& detection : frame.detections) {
    const int id = detection.tag.id;
    const double sigma_px = id == 1 ? 4.0 : 0.1;
    detection.covariance_px2 = sigma_px * sigma_px * CornerCovariance::Identity();
    if (id != 1 && id != 2) continue;
    for (Eigen::Vector2d& corner : detection.corners_px) corner += Eigen::Vector2d(5.0, -4.0);
  }
  const TrackResult result = Localizer(camera, map).localize(frame);
  ASSERT_TRUE(result.pose) << result.reason;
  ASSERT_EQ(result.contradicting_tags.size(), 1U);
  EXPECT_EQ(result.contradicting_tags[0].id, 2);
  EXPECT_LT(result.pose->translation().norm(), 1e-3);
}

TEST(PoseAdjustment, WhitenedErrorsHaveTheCovarianceOfTheDetection) {
  const Camera camera = test::radtan();
  const TagMap map = test::only(test::room(), {3});
  const FrameDetections frame = with_covariances(test::seen(camera, map, Pose()));
  const auto observations = observe_mapped_tags(map, TagIndex(map), camera.model, frame.detections, 0.1);
  const CornerCovariance& W = observations.at(0).whitening_per_px;
  EXPECT_TRUE((W * observations[0].covariance_px2 * W.transpose()).isIdentity(1e-9));
  const Eigen::MatrixXd J = test::numeric_jacobian(
      [&](const Eigen::VectorXd& xi) { return stacked(test::seen(camera, map, Pose::exp(xi))); }, 6);
  const Eigen::MatrixXd expected = J.transpose() * observations[0].covariance_px2.inverse() * J;
  EXPECT_TRUE(
      test::jacobians_agree(corner_information(camera.model, {&observations[0]}, Pose()), expected, 1e-6));
}

/// Moves all corners to the right.
Detection moved(Detection detection, double right_px) {
  for (Eigen::Vector2d& corner : detection.corners_px) corner.x() += right_px;
  return detection;
}

TEST(Localizer, TakesTheLikelierCopyNotTheOneThatClaimsLess) {
  // Squares of .38 px at .1 px are 58; of 2 px at .7 px they are 33, but so wide a claim costs 31 (ln det).
  const Camera camera = test::camera_with(NoDistortion{});
  const TagMap map = test::room();
  FrameDetections frame = test::seen(camera, map, Pose());
  Detection misread = moved(frame.detections.front(), 2.0);
  misread.hamming = 2;
  frame.detections.front() = moved(frame.detections.front(), 0.38);
  frame.detections.push_back(misread);
  const auto observations = observe_mapped_tags(map, TagIndex(map), camera.model, frame.detections, 0.1);
  const auto found = find_pose_candidates(camera.model, observations, {Pose()}, {});
  ASSERT_FALSE(found.empty());
  for (const PoseCandidate& candidate : found)
    EXPECT_EQ(std::ranges::count(candidate.inliers, &observations.back()), 0);
}

TEST(Localizer, LeavesOutCornersWhoseCovarianceIsNotPositive) {
  const Camera camera = test::camera_with(NoDistortion{});
  const TagMap map = test::room();
  FrameDetections frame = with_covariances(test::seen(camera, map, Pose()));
  const std::size_t all = frame.detections.size();
  frame.detections[0].covariance_px2 = -CornerCovariance::Identity();
  (*frame.detections[1].covariance_px2)(2, 2) = std::nan("");
  EXPECT_EQ(observe_mapped_tags(map, TagIndex(map), camera.model, frame.detections, 0.1).size(), all - 2);
  Localizer localizer(camera, map);
  const TrackResult result = localizer.localize(frame);
  ASSERT_TRUE(result.pose);
  EXPECT_TRUE(result.pose->is_finite());
}

}  // namespace
}  // namespace apriltrack
