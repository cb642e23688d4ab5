#include "apriltrack/eval/trajectory.h"

#include <gmock/gmock.h>

#include <fstream>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "support/error_message.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

fs::path write(const std::string& text) {
  const fs::path path = test::temporary_folder() / "t.tum";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

void expect_tum_error(const std::string& text, const std::string& words) {
  try {
    read_tum(write(text));
    FAIL() << "read without complaint: " << text;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    EXPECT_THAT(error.what(), HasSubstr(words));
  }
}

TEST(Tum, ReadsTimesToTheNanosecond) {
  const Trajectory t =
      read_tum(write("1403636579.763555584 1 2 3 0 0 0 1\n"
                     "1403636580.5 1 2 3 0 0 0 1\n"
                     "1403636581 1 2 3 0 0 0 1\n"
                     "1.403636582123456789e+09 1 2 3 0 0 0 1\n"
                     "1403636583.1234567899 1 2 3 0 0 0 1\n"));
  ASSERT_EQ(t.size(), 5u);
  EXPECT_EQ(t[0].timestamp.ns, 1403636579763555584);
  EXPECT_EQ(t[1].timestamp.ns, 1403636580500000000);
  EXPECT_EQ(t[2].timestamp.ns, 1403636581000000000);
  EXPECT_EQ(t[3].timestamp.ns, 1403636582123456789);
  EXPECT_EQ(t[4].timestamp.ns, 1403636583123456789);
}

TEST(Tum, ReadsSmallExponents) {
  const Trajectory t = read_tum(write("1.5e-03 0 0 0 0 0 0 1\n2e+00 0 0 0 0 0 0 1\n"));
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t[0].timestamp.ns, 1500000);
  EXPECT_EQ(t[1].timestamp.ns, 2000000000);
}

TEST(Tum, WhatIsNoNumberIsNoTimeWhateverItsExponent) {
  for (const std::string time : {"e5", "-e5", ".e3", "1.2.3e4", "1e", "1e+", "1x2e3", "0x1e3", "1.5e3.0"})
    expect_tum_error(time + " 0 0 0 0 0 0 1\n", "t.tum:1: timestamp: '" + time + "' is no time in seconds");
}

TEST(Tum, PassesOverCommentsBlanksAndCarriageReturns) {
  const Trajectory t = read_tum(write("# time x y z\r\n\r\n  1.0\t1 2 3  0 0 0.6 0.8 # good\r\n"));
  ASSERT_EQ(t.size(), 1u);
  EXPECT_THAT(t[0].pose, test::PoseNear(Pose(Eigen::Quaterniond(0.8, 0, 0, 0.6), Eigen::Vector3d(1, 2, 3)),
                                        1e-15, 1e-15));
}

TEST(Tum, SortsByTime) {
  const Trajectory t = read_tum(write("2 2 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n3 3 0 0 0 0 0 1"));
  ASSERT_EQ(t.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(t[i].pose.translation().x(), i + 1.0);
}

TEST(Tum, EmptyFilesHaveNoPose) {
  EXPECT_TRUE(read_tum(write("# nothing\n")).empty());
}

TEST(Tum, ErrorsNameFileAndLine) {
  expect_tum_error("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n", "t.tum:2: has 7 columns");
  expect_tum_error("1 0 0 0 0 0 0 1\n\n1.000 0 0 0 0 0 0 1\n",
                   "t.tum:3: timestamp 1.000000000 stands in line 1 already");
  expect_tum_error("1 0 nan 0 0 0 0 1\n", "t.tum:1: ty: 'nan' is not a finite number");
  expect_tum_error("1 0 0 1,5 0 0 0 1\n", "tz: '1,5'");
  expect_tum_error("1 0 0 inf 0 0 0 1\n", "tz: 'inf'");
  expect_tum_error("1 0 0 0 0 0 0 0\n", "length of the quaternion must be 1 (is 0)");
  expect_tum_error("1 0 0 0 1 1 1 1\n", "length of the quaternion must be 1 (is 2)");
  expect_tum_error("noon 0 0 0 0 0 0 1\n", "'noon' is no time");
  expect_tum_error("1403636579763555584 0 0 0 0 0 0 1\n", "looks like nanoseconds");
}

TEST(Tum, MissingFilesAreIoErrors) {
  const auto read = [] { read_tum(test::temporary_folder() / "none.tum"); };
  EXPECT_THAT(test::message_of(read, ErrorKind::kIo), HasSubstr("none.tum"));
}

TEST(Tum, WritesWhatItReads) {
  const Pose pose(Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), Eigen::Vector3d(-1.25, 1e-9, 123.456789012));
  const fs::path path = test::temporary_folder() / "out.tum";
  write_tum(path, {{{-5}, pose}, {{1403636579763555584}, pose}});
  std::ifstream file(path);
  std::string first;
  std::getline(file, first);
  EXPECT_EQ(first, "-0.000000005 -1.25 1e-09 123.456789012 -0.5 0.5 0.5 0.5");
  const Trajectory back = read_tum(path);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[1].timestamp.ns, 1403636579763555584);
  EXPECT_EQ(back[1].pose.translation(), pose.translation());  // to the last bit
  EXPECT_EQ(back[1].pose.rotation().coeffs(), pose.rotation().coeffs());
}

TEST(Tum, RefusesToWriteWhatIsNoTrajectory) {
  const fs::path path = test::temporary_folder() / "out.tum";
  EXPECT_THROW(write_tum(path, {{{2}, Pose()}, {{1}, Pose()}}), MisuseError);
  const Pose nowhere(Eigen::Quaterniond::Identity(), Eigen::Vector3d(std::nan(""), 0, 0));
  EXPECT_THROW(write_tum(path, {{{1}, nowhere}}), MisuseError);
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace apriltrack
