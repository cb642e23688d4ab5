#include "apriltrack/eval/evaluate_trajectory.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/evaluate_frame_log.h"
#include "eval/synthetic.h"
#include "support/pose_matchers.h"

namespace apriltrack {
namespace {

using ::testing::HasSubstr;

constexpr double kFocal_px = 500.0;

/// Camera at the origin that looks along z, and one upright tag of 0.2 m two metres before it.
CornerScene one_tag_scene() {
  Camera camera{.model = CameraModel({kFocal_px, kFocal_px, 320.0, 240.0}, NoDistortion{}),
                .width = 640,
                .height = 480};
  CornerScene scene{camera, {}};
  scene.map.tags.push_back(test::tag_at(0, Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, 2))));
  return scene;
}

Pose shift(double x, double y, double z) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, y, z)};
}

Pose turn_about(const Eigen::Vector3d& axis, double angle_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis)), Eigen::Vector3d::Zero()};
}

Trajectory still(const Pose& pose, int num_frames = 3) {
  Trajectory trajectory;
  for (int i = 0; i < num_frames; ++i) trajectory.push_back({{i * 100'000'000LL}, pose});
  return trajectory;
}

TrajectoryEvaluation evaluate_ego(const Trajectory& truth, const Trajectory& estimate,
                                  const CornerScene* scene = nullptr) {
  return evaluate_trajectory(truth, estimate, scene, {});
}

std::string no_result_message(const Trajectory& truth, const Trajectory& estimate,
                              const CornerScene* scene = nullptr, bool align = false) {
  try {
    evaluate_trajectory(truth, estimate, scene, {TrajectoryKind::kEgo, align});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kNoResult);
    return error.what();
  }
  return "no error";
}

// Their signed difference would wrap to -1 ns: a match.
TEST(EvaluateTrajectory, TimesAtBothEndsOfTheClockDoNotMeet) {
  const std::int64_t first = std::numeric_limits<std::int64_t>::min();
  const std::int64_t last = std::numeric_limits<std::int64_t>::max();
  const Trajectory early{{{first}, Pose()}};
  const Trajectory late{{{last}, Pose()}};
  EXPECT_THAT(no_result_message(early, late), HasSubstr("no frame is in both"));
  EXPECT_THAT(no_result_message(late, early), HasSubstr("no frame is in both"));
}

TEST(EvaluateTrajectory, TruthScoresZero) {
  const CornerScene scene = one_tag_scene();
  const Trajectory truth = still(shift(0.1, 0, 0));
  const auto e = evaluate_ego(truth, truth, &scene);
  EXPECT_EQ(e.overall.frames, 3);
  EXPECT_EQ(e.overall.coverage, 1.0);
  EXPECT_EQ(e.overall.success_5px, 1.0);
  EXPECT_LT(*e.overall.p95_px, 1e-12);
  EXPECT_LT(*e.overall.position_rmse_m, 1e-15);
  EXPECT_LT(*e.overall.rotation_rmse_rad, 1e-15);
}

TEST(EvaluateTrajectory, AKnownOffsetMovesEveryCornerByFocalTimesOffsetOverDepth) {
  const CornerScene scene = one_tag_scene();
  const auto e = evaluate_ego(still(Pose()), still(shift(0.008, 0, 0)), &scene);
  EXPECT_NEAR(*e.overall.median_px, kFocal_px * 0.008 / 2.0, 1e-12);
  EXPECT_NEAR(*e.overall.position_rmse_m, 0.008, 1e-15);
  EXPECT_EQ(e.overall.success_5px, 1.0);
  const auto far = evaluate_ego(still(Pose()), still(shift(0.021, 0, 0)), &scene);
  EXPECT_NEAR(*far.overall.median_px, 5.25, 1e-12);
  EXPECT_EQ(far.overall.success_5px, 0.0);
}

TEST(EvaluateTrajectory, AKnownTurnAboutTheAxisMovesCornersAlongTheirCircle) {
  const CornerScene scene = one_tag_scene();
  const double angle = 0.01;
  const auto e = evaluate_ego(still(Pose()), still(turn_about(Eigen::Vector3d::UnitZ(), angle)), &scene);
  const double radius_px = kFocal_px * 0.1 * std::numbers::sqrt2 / 2.0;
  EXPECT_NEAR(*e.overall.median_px, 2.0 * radius_px * std::sin(angle / 2.0), 1e-10);
  EXPECT_NEAR(*e.overall.rotation_rmse_rad, angle, 1e-14);
  EXPECT_LT(*e.overall.position_rmse_m, 1e-15);
}

TEST(EvaluateTrajectory, JointPosesMoveTheBodyBeforeTheCamera) {
  const CornerScene scene = one_tag_scene();
  // The body's origin stands one metre off, its tag another two: depth 3.
  const auto e = evaluate_trajectory(still(shift(0, 0, 1)), still(shift(0.003, 0, 1)), &scene,
                                     {TrajectoryKind::kJoint, false});
  EXPECT_NEAR(*e.overall.median_px, kFocal_px * 0.003 / 3.0, 1e-12);
}

TEST(EvaluateTrajectory, TagsBehindTheEstimateCostTheFullError) {
  const CornerScene scene = one_tag_scene();
  const auto e =
      evaluate_ego(still(Pose()), still(turn_about(Eigen::Vector3d::UnitY(), std::numbers::pi)), &scene);
  EXPECT_EQ(*e.overall.median_px, 1e4);
}

TEST(EvaluateTrajectory, FramesWithoutAPoseFail) {
  const CornerScene scene = one_tag_scene();
  Trajectory estimate = still(Pose(), 4);
  estimate.erase(estimate.begin() + 1);
  const auto e = evaluate_ego(still(Pose(), 4), estimate, &scene);
  EXPECT_EQ(e.overall.frames, 4);
  EXPECT_EQ(e.overall.coverage, 0.75);
  EXPECT_EQ(e.overall.success_5px, 0.75);
  EXPECT_LT(*e.overall.median_px, 1e-12);
}

TEST(EvaluateTrajectory, OnlyFramesWhoseTruthShowsATagCount) {
  const CornerScene scene = one_tag_scene();
  Trajectory truth = still(Pose(), 6);
  truth[1].pose = turn_about(Eigen::Vector3d::UnitY(), std::numbers::pi);  // looks away
  truth[2].pose = shift(0, 0, 1.99);                                       // nearer than 2 cm
  truth[3].pose = shift(1.3, 0, 0);  // 325 px off the centre, out of the image
  const Pose T_world_pivot = shift(0, 0, 2);
  const auto circle = [&](double angle_deg) {  // round the tag, looking at it from the side
    return T_world_pivot * turn_about(Eigen::Vector3d::UnitY(), angle_deg * std::numbers::pi / 180.0) *
           shift(0, 0, -2);
  };
  truth[4].pose = circle(79.5);
  truth[5].pose = circle(80.5);
  const auto e = evaluate_ego(truth, truth, &scene);
  ASSERT_EQ(e.frames.size(), 2u);
  EXPECT_EQ(e.frames[0].timestamp, truth[0].timestamp);
  EXPECT_EQ(e.frames[1].timestamp, truth[4].timestamp);
  EXPECT_EQ(e.truth_frames, 6);
}

TEST(EvaluateTrajectory, BlurIsTheWayDuringTheExposure) {
  CornerScene scene = one_tag_scene();
  scene.camera.exposure_s = 0.02;
  Trajectory truth = still(Pose(), 3);
  for (int i = 0; i < 3; ++i) truth[i].pose = shift(0.1 * i, 0, 0);  // 1 m/s at 2 m: 250 px/s
  const auto e = evaluate_ego(truth, truth, &scene);
  ASSERT_EQ(e.frames.size(), 3u);
  for (const FrameScore& frame : e.frames) EXPECT_NEAR(frame.blur_px, 250.0 * 0.02, 1e-9);
  scene.camera.exposure_s = 0.04 + 1e-9;
  const auto slow = evaluate_ego(truth, truth, &scene);
  ASSERT_EQ(slow.by_blur.size(), 1u);
  EXPECT_EQ(slow.by_blur[0].from_px, 10.0);
  EXPECT_EQ(slow.by_blur[0].summary.frames, 3);
}

TEST(EvaluateTrajectory, TakesTheNearestPoseWithinAMillisecond) {
  const Trajectory truth = {{{1'000'000'000}, Pose()}};
  const Trajectory estimate = {
      {{999'100'000}, shift(3, 0, 0)}, {{1'000'400'000}, shift(1, 0, 0)}, {{1'000'500'000}, shift(2, 0, 0)}};
  const auto e = evaluate_ego(truth, estimate);
  EXPECT_EQ(*e.overall.position_rmse_m, 1.0);
  EXPECT_EQ(e.unmatched_estimates, 0);
  EXPECT_THAT(no_result_message(truth, {{{1'001'000'000}, Pose()}}), HasSubstr("within 1 ms"));
  EXPECT_EQ(evaluate_ego(truth, {{{1'000'999'999}, Pose()}}).overall.coverage, 1.0);
}

TEST(EvaluateTrajectory, TellsByHowMuchTheClocksDiffer) {
  Trajectory late = still(Pose(), 5);
  for (TimedPose& pose : late) pose.timestamp.ns += 12'500'000'000;
  EXPECT_THAT(no_result_message(still(Pose(), 5), late),
              HasSubstr("taking 12.500000000 s off the estimate's times would join 5 of its 5"));
}

TEST(EvaluateTrajectory, ErrorsSayWhatIsMissing) {
  EXPECT_THAT(no_result_message({}, still(Pose())), HasSubstr("truth: has no pose"));
  EXPECT_THAT(no_result_message(still(Pose()), {}), HasSubstr("the estimate has no pose at all"));
  CornerScene scene = one_tag_scene();
  const Trajectory away = still(turn_about(Eigen::Vector3d::UnitY(), std::numbers::pi));
  EXPECT_THAT(no_result_message(away, away, &scene), HasSubstr("shows no tag in any frame"));
  EXPECT_THAT(no_result_message(still(Pose(), 2), still(Pose(), 2), nullptr, true),
              HasSubstr("do not settle a rotation"));
  scene.camera.width = 0;
  EXPECT_THROW(evaluate_ego(still(Pose()), still(Pose()), &scene), Error);
}

TEST(EvaluateTrajectory, AlignmentTakesOffAKnownMotionOnlyWhenAsked) {
  const Trajectory truth = test::arc(40);
  Vector6d xi;
  xi << 1, -2, 0.5, 0.7, -0.2, 1.1;
  const Pose T_estimate_truth = Pose::exp(xi);
  Trajectory estimate = truth;
  for (TimedPose& pose : estimate) pose.pose = T_estimate_truth * pose.pose;
  const auto plain = evaluate_ego(truth, estimate);
  EXPECT_GT(*plain.overall.position_rmse_m, 1.0);
  EXPECT_FALSE(plain.T_truth_estimate.has_value());
  EXPECT_LT(*plain.aligned_position_rmse_m, 1e-14);
  EXPECT_LT(plain.relative->position_rmse_m, 1e-14);  // no drift
  EXPECT_EQ(plain.relative->pairs, 39);
  const auto aligned = evaluate_trajectory(truth, estimate, nullptr, {TrajectoryKind::kEgo, true});
  EXPECT_LT(*aligned.overall.position_rmse_m, 1e-14);
  EXPECT_LT(*aligned.overall.rotation_rmse_rad, 1e-14);
  EXPECT_THAT(*aligned.T_truth_estimate, test::PoseNear(T_estimate_truth.inverse(), 1e-13, 1e-13));
}

TEST(EvaluateTrajectory, RelativeErrorIsTheDriftOfOneFrame) {
  const Trajectory truth = test::arc(30);
  const Pose drift = shift(0.003, 0, 0.004);
  Trajectory estimate = {truth.front()};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose step = truth[i - 1].pose.inverse() * truth[i].pose;
    estimate.push_back({truth[i].timestamp, estimate.back().pose * step * drift});
  }
  estimate.erase(estimate.begin() + 10);  // breaks two pairs
  const auto e = evaluate_ego(truth, estimate);
  EXPECT_EQ(e.relative->pairs, 27);
  EXPECT_NEAR(e.relative->position_rmse_m, 0.005, 1e-12);
  EXPECT_LT(e.relative->rotation_rmse_rad, 1e-12);
}

struct LoggedRun {
  Trajectory truth;
  Trajectory estimate;
  std::vector<FrameLogRow> log;
};

/// Estimates whose error is drawn from covariance * spread^2 about the truth, and a log that claims
/// `covariance`.
LoggedRun noisy_run(int num_frames, double spread) {
  RandomStream random(20240611);
  LoggedRun run;
  run.truth = test::arc(num_frames);
  for (const TimedPose& truth : run.truth) {
    const Matrix6d covariance = test::random_covariance(random, 1e-3);
    const Pose estimate = truth.pose * Pose::exp(spread * test::sample(random, covariance)).inverse();
    run.estimate.push_back({truth.timestamp, estimate});
    FrameLogRow row;
    row.timestamp = truth.timestamp;
    row.status = "tracked";
    row.pose = estimate;
    row.covariance = covariance;
    row.sigma_position_m = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    run.log.push_back(row);
  }
  return run;
}

TEST(EvaluateFrameLog, AnHonestCovarianceScoresOneAndABoastfulOneFour) {
  constexpr int kFrames =
      4000;  // chi squared with 6 degrees: the mean over 6 scatters by sqrt(2/6/4000) = 0.009
  for (const double spread : {1.0, 2.0}) {
    const LoggedRun run = noisy_run(kFrames, spread);
    const auto result = evaluate_frame_log(evaluate_ego(run.truth, run.estimate), run.log);
    EXPECT_EQ(result.claimed_good, kFrames);
    EXPECT_NEAR(*result.nees_over_6_mean, spread * spread, 0.04 * spread * spread);
    EXPECT_NEAR(*result.nees_over_6_median, spread * spread * 5.3481 / 6.0,
                0.05 * spread * spread);  // chi2(6) table
    EXPECT_NEAR(*result.mean_squared_position_error_over_sigma2, spread * spread, 0.06 * spread * spread);
  }
}

// The covariance is of the pose in the map's frame. An alignment moves all poses by one motion that no
// covariance knows of.
TEST(EvaluateFrameLog, DoesNotJudgeTheCovariancesOfAnAlignedEstimate) {
  const LoggedRun run = noisy_run(100, 1.0);
  const auto aligned = evaluate_trajectory(run.truth, run.estimate, nullptr, {TrajectoryKind::kEgo, true});
  const auto result = evaluate_frame_log(aligned, run.log);
  EXPECT_EQ(result.claimed_good, 100);
  EXPECT_FALSE(result.judges_covariances);
  EXPECT_FALSE(result.nees_over_6_mean.has_value());
  EXPECT_FALSE(result.mean_squared_position_error_over_sigma2.has_value());
  EXPECT_TRUE(evaluate_frame_log(evaluate_ego(run.truth, run.estimate), run.log).judges_covariances);
}

FrameLogRow row_at(Timestamp time, const std::string& status, double latency_ms) {
  FrameLogRow row;
  row.timestamp = time;
  row.status = status;
  row.latency_ms = latency_ms;
  return row;
}

TEST(EvaluateFrameLog, CountsClaimsAndSilentFailures) {
  const CornerScene scene = one_tag_scene();
  const Trajectory truth = still(Pose(), 5);
  Trajectory estimate = truth;
  estimate[1].pose = shift(0.041, 0, 0);  // 10.25 px
  estimate[2].pose = shift(0.039, 0, 0);  // 9.75 px
  estimate[3].pose = shift(0.5, 0, 0);    // wrong, but only predicted
  estimate.pop_back();
  const auto e = evaluate_ego(truth, estimate, &scene);
  const auto result = evaluate_frame_log(
      e, {row_at(truth[0].timestamp, "detected", 1), row_at(truth[1].timestamp, "tracked", 2),
          row_at(truth[2].timestamp, "tracked", 3), row_at(truth[3].timestamp, "predicted", 4),
          row_at(truth[4].timestamp, "lost", 10)});
  EXPECT_EQ(result.claimed_good, 3);
  EXPECT_EQ(result.claimed_without_pose, 0);
  EXPECT_EQ(result.claimed_good_but_over_10px, 1);
  EXPECT_EQ(result.claimed_share_of_frames, 0.6);
  EXPECT_EQ(result.statuses,
            (std::map<std::string, int>{{"detected", 1}, {"tracked", 2}, {"predicted", 1}, {"lost", 1}}));
  EXPECT_EQ(result.latency_p50_ms, 3.0);
  EXPECT_NEAR(*result.latency_p99_ms, 9.76, 1e-12);
  EXPECT_FALSE(result.nees_over_6_mean.has_value());
}

TEST(EvaluateFrameLog, CountsClaimsOfPosesThatTheEstimateLacks) {
  const Trajectory truth = still(Pose(), 5);
  Trajectory estimate = truth;
  estimate.erase(estimate.begin() + 1, estimate.begin() + 4);
  const auto result = evaluate_frame_log(
      evaluate_ego(truth, estimate),
      {row_at(truth[0].timestamp, "detected", 1), row_at(truth[1].timestamp, "detected", 1),
       row_at(truth[2].timestamp, "tracked", 1), row_at(truth[3].timestamp, "predicted", 1)});
  EXPECT_EQ(result.claimed_without_pose, 2);
  EXPECT_EQ(result.claimed_good, 1);
}

TEST(EvaluateFrameLog, RefusesALogOfAnotherRecording) {
  const Trajectory truth = still(Pose());
  const auto e = evaluate_ego(truth, truth);
  try {
    evaluate_frame_log(e, {row_at({77}, "detected", 1)});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kNoResult);
    EXPECT_THAT(error.what(), HasSubstr("is it of the same recording"));
  }
  EXPECT_THROW(evaluate_frame_log(e, {}), Error);
}

TEST(EvaluateFrameLog, RefusesACovarianceWithoutInverse) {
  const Trajectory truth = still(Pose());
  FrameLogRow row = row_at(truth[0].timestamp, "detected", 1);
  row.covariance = Matrix6d::Zero();
  EXPECT_THROW(evaluate_frame_log(evaluate_ego(truth, still(shift(1, 0, 0))), {row}), Error);
}

}  // namespace
}  // namespace apriltrack
