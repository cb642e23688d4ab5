#include "apriltrack/eval/frame_log.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

FrameLogRow detected_row() {
  FrameLogRow row;
  row.timestamp = {1403636579763555584};
  row.status = "detected";
  row.pose = Pose(Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), Eigen::Vector3d(1, -2, 3));
  row.tags_detected = 3;
  row.tags_tracked = 1;
  row.latency_ms = 4.25;
  row.second_mode_odds = 0.125;
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = 1e-3 * std::sin(1.0 + i);
  row.covariance = root * root.transpose() + 1e-8 * Matrix6d::Identity();
  return row;
}

FrameLogRow lost_row() {
  FrameLogRow row;
  row.timestamp = {1403636579800000000};
  row.status = "lost";
  return row;
}

void expect_log_error(const std::string& text, const std::string& words) {
  const fs::path path = test::temporary_folder() / "f.csv";
  std::ofstream(path) << text;
  try {
    read_frame_log(path);
    FAIL() << "read without complaint: " << text;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(FrameLog, ReadsWhatItWrites) {
  const fs::path path = test::temporary_folder() / "f.csv";
  const FrameLogRow row = detected_row();
  write_frame_log(path, {row, lost_row()});
  const auto rows = read_frame_log(path);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].timestamp, row.timestamp);
  EXPECT_EQ(rows[0].status, "detected");
  EXPECT_EQ(rows[0].tags_detected, 3);
  EXPECT_EQ(rows[0].tags_tracked, 1);
  EXPECT_EQ(rows[0].latency_ms, 4.25);
  EXPECT_EQ(rows[0].second_mode_odds, 0.125);
  ASSERT_TRUE(rows[0].pose && rows[0].covariance && rows[0].sigma_position_m && rows[0].sigma_rotation_rad);
  EXPECT_THAT(*rows[0].pose, test::PoseNear(*row.pose, 1e-8, 1e-8));
  EXPECT_TRUE(rows[0].covariance->isApprox(*row.covariance, 1e-11));
  EXPECT_NEAR(*rows[0].sigma_position_m, std::sqrt(row.covariance->topLeftCorner<3, 3>().trace()), 1e-11);
  EXPECT_NEAR(*rows[0].sigma_rotation_rad, std::sqrt(row.covariance->bottomRightCorner<3, 3>().trace()),
              1e-11);
  EXPECT_EQ(rows[1].status, "lost");
  EXPECT_FALSE(rows[1].pose || rows[1].covariance || rows[1].latency_ms || rows[1].sigma_position_m);
}

TEST(FrameLog, HeaderIsTheContracts) {
  const fs::path path = test::temporary_folder() / "f.csv";
  write_frame_log(path, {});
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(),
            "timestamp_ns,status,tx,ty,tz,qx,qy,qz,qw,tags_detected,tags_tracked,sigma_position_m,sigma_"
            "rotation_rad,"
            "latency_ms,second_mode_odds,cov_00,cov_01,cov_02,cov_03,cov_04,cov_05,cov_11,cov_12,cov_13,cov_"
            "14,cov_15,"
            "cov_22,cov_23,cov_24,cov_25,cov_33,cov_34,cov_35,cov_44,cov_45,cov_55,detection_ms\n");
}

TEST(FrameLog, FindsColumnsByName) {
  const fs::path path = test::temporary_folder() / "f.csv";
  std::ofstream(path) << "status,extra,timestamp_ns,sigma_position_m\ntracked,7,100,0.25\n";
  const auto rows = read_frame_log(path);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].timestamp.ns, 100);
  EXPECT_EQ(rows[0].sigma_position_m, 0.25);
  EXPECT_TRUE(claims_evidence(rows[0]));
}

TEST(FrameLog, ErrorsNameLineAndColumn) {
  expect_log_error("timestamp_ns,state\n1,lost\n", "status");
  expect_log_error("timestamp_ns,status\n1,lost\n2,fine\n", "f.csv:3: status: 'fine' is none of");
  expect_log_error("timestamp_ns,status,tx,ty,tz,qx,qy,qz,qw\n1,lost,1,,,,,,\n", "f.csv:2: tx ... qw");
  expect_log_error("timestamp_ns,status,tx,ty,tz,qx,qy,qz,qw\n1,lost,1,1,1,0,0,0,nan\n", "qw");
  expect_log_error("timestamp_ns,status,cov_00\n1,tracked,1\n", "cov_01: is missing");
  expect_log_error("timestamp_ns,status,sigma_position_m\n1,tracked,-1\n", "sigma_position_m: must be >= 0");
  expect_log_error("timestamp_ns,status,tags_detected\n1,tracked,-1\n", "tags_detected");
}

TEST(FrameLog, RefusesUnknownStatuses) {
  FrameLogRow row = lost_row();
  row.status = "fine";
  EXPECT_THROW(write_frame_log(test::temporary_folder() / "f.csv", {row}), MisuseError);
}

}  // namespace
}  // namespace apriltrack
