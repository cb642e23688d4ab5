// What a user asks of a run, from the rows of its frame log: counted by hand.

#include "apriltrack/eval/run_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace apriltrack {
namespace {

FrameLogRow row(int number, const std::string& status, std::optional<double> latency_ms = std::nullopt) {
  FrameLogRow made;
  made.timestamp = Timestamp{number * std::int64_t{100'000'000}};
  made.status = status;
  made.latency_ms = latency_ms;
  if (status != "lost" && status != "unreadable") made.pose = Pose();
  return made;
}

TEST(RunStatistics, CountFramesByStatusAndFindTheFirstPose) {
  const std::vector<FrameLogRow> rows = {row(0, "unreadable"), row(1, "lost", 3.0), row(2, "detected", 5.0),
                                         row(3, "tracked", 9.0), row(4, "predicted", 9.0)};
  const RunStatistics run = run_statistics(rows, std::vector<std::string>(5));
  EXPECT_EQ(run.frames, 5U);
  EXPECT_EQ(run.with_evidence, 2U);
  EXPECT_DOUBLE_EQ(run.duration_s, 0.4);
  for (std::size_t i = 0; i < kFrameStatuses.size(); ++i) {
    EXPECT_EQ(run.statuses[i].status, kFrameStatuses[i]);
    EXPECT_EQ(run.statuses[i].frames, 1U) << kFrameStatuses[i];
  }
  EXPECT_DOUBLE_EQ(run.first_pose_s.value(), 0.2);
  EXPECT_DOUBLE_EQ(run.latency_max_ms.value(), 9.0);
  EXPECT_DOUBLE_EQ(run.latency_max_at_s, 0.3) << "the first of those that took longest";
}

TEST(RunStatistics, BlindStretchesReachFromEvidenceToEvidenceTheLongestFirst) {
  const std::vector<FrameLogRow> rows = {row(0, "detected"),  row(1, "lost"), row(2, "detected"),
                                         row(3, "predicted"), row(4, "lost"), row(5, "lost"),
                                         row(6, "tracked")};
  const std::vector<std::string> reasons = {"", "dark", "", "", "far", "far", ""};
  const RunStatistics run = run_statistics(rows, reasons);
  ASSERT_EQ(run.blind.size(), 2U);
  EXPECT_DOUBLE_EQ(run.blind[0].from_s, 0.2);
  EXPECT_DOUBLE_EQ(run.blind[0].to_s, 0.6);
  EXPECT_EQ(run.blind[0].predicted, 1U);
  EXPECT_EQ(run.blind[0].lost, 2U);
  EXPECT_EQ(run.blind[0].reason, "far");
  EXPECT_DOUBLE_EQ(run.blind[1].duration_s(), 0.2);
  EXPECT_EQ(run.blind[1].reason, "dark");
}

TEST(RunStatistics, ClaimedErrorsAreThoseOfWholeVectors) {
  std::vector<FrameLogRow> rows = {row(0, "detected"), row(1, "detected"), row(2, "lost")};
  rows[0].covariance = Matrix6d::Identity();
  rows[1].covariance = 4.0 * Matrix6d::Identity();
  const RunStatistics run = run_statistics(rows, std::vector<std::string>(3));
  ASSERT_TRUE(run.sigma);
  EXPECT_DOUBLE_EQ(run.sigma->worst_position_m, std::sqrt(12.0));
  EXPECT_DOUBLE_EQ(run.sigma->worst_rotation_rad, std::sqrt(12.0));
  EXPECT_FALSE(run.statuses[index_of_status("lost")].sigma);
}

TEST(RunStatistics, OfARunWithoutAPose) {
  const std::vector<FrameLogRow> rows = {row(0, "unreadable"), row(1, "lost")};
  const RunStatistics run = run_statistics(rows, std::vector<std::string>(2));
  EXPECT_FALSE(run.first_pose_s);
  EXPECT_FALSE(run.latency_max_ms);
  ASSERT_EQ(run.blind.size(), 1U);
  EXPECT_EQ(run.blind[0].frames(), 2U);
}

}  // namespace
}  // namespace apriltrack
