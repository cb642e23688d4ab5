// Trajectories of other projects, written out by hand from their documents; what we write is judged by numpy
// as evo reads it.
#include "apriltrack/eval/trajectory_formats.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdio>
#include <fstream>
#include <sstream>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "support/error_message.h"
#include "support/judge_output.h"
#include "support/judges.h"
#include "support/pose_matchers.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kHalfRoot = 0.7071067811865476;
constexpr double kRounding = 1e-15;

/// A quarter turn about z; x to y to z to x; a quarter turn about x.
const char* const kTum =
    "1403636579.763555584 1.5 -2.25 0.125 0 0 0.7071067811865476 0.7071067811865476\n"
    "1403636580.013555584 2 -2 0.5 0.5 0.5 0.5 0.5\n"
    "1403636580.263555584 2.25 -1.5 0.75 0.7071067811865476 0 0 0.7071067811865476\n";
const char* const kEurocHeader =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
    "v_RS_R_x "
    "[m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
    "b_w_RS_S_z [rad "
    "s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
/// Velocities: (0.5, 0.25, 0.375) m in 0.25 s, (0.75, 0.75, 0.625) m in 0.5 s, (0.25, 0.5, 0.25) m in 0.25 s.
const char* const kEurocRows =
    "1403636579763555584,1.5,-2.25,0.125,0.7071067811865476,0,0,0.7071067811865476,2,1,1.5,0,0,0,0,0,0\n"
    "1403636580013555584,2,-2,0.5,0.5,0.5,0.5,0.5,1.5,1.5,1.25,0,0,0,0,0,0\n"
    "1403636580263555584,2.25,-1.5,0.75,0.7071067811865476,0.7071067811865476,0,0,1,2,1,0,0,0,0,0,0\n";
const char* const kKitti =
    "0 -1 0 1.5 1 0 0 -2.25 0 0 1 0.125\n"
    "0 0 1 2 1 0 0 -2 0 1 0 0.5\n"
    "1.000000e+00 0 0 2.250000e+00 0 0 -1 -1.5 0 1 0 0.75\n";
const char* const kTimes = "1403636579.763555584\n1403636580.013555584\n1.403636580263555584e+09\n";

Trajectory by_hand() {
  return {{{1403636579763555584}, {Eigen::Quaterniond(kHalfRoot, 0, 0, kHalfRoot), {1.5, -2.25, 0.125}}},
          {{1403636580013555584}, {Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {2, -2, 0.5}}},
          {{1403636580263555584}, {Eigen::Quaterniond(kHalfRoot, kHalfRoot, 0, 0), {2.25, -1.5, 0.75}}}};
}

fs::path file(const fs::path& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder / name, std::ios::binary) << text;
  return folder / name;
}

void expect_by_hand(const Trajectory& trajectory) {
  const Trajectory expected = by_hand();
  ASSERT_EQ(trajectory.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(trajectory[i].timestamp.ns, expected[i].timestamp.ns);
    EXPECT_THAT(trajectory[i].pose, test::PoseNear(expected[i].pose, kRounding, 4 * kRounding)) << i;
  }
}

std::vector<std::string> words_of(const std::vector<ConversionLoss>& losses) {
  std::vector<std::string> words;
  for (const ConversionLoss& loss : losses)
    words.push_back(fmt::format("{} {}", to_string(loss.kind), to_string(loss.how)));
  return words;
}

TEST(TrajectoryFormats, AreReadByTheirContentWhateverTheirName) {
  const fs::path folder = test::temporary_folder();
  const TrajectoryReading tum = read_trajectory_file(file(folder, "a.kitti", kTum));
  EXPECT_EQ(tum.format, TrajectoryFormat::kTum);
  EXPECT_TRUE(tum.losses.empty());
  expect_by_hand(tum.trajectory);
  const TrajectoryReading euroc =
      read_trajectory_file(file(folder, "a.tum", std::string(kEurocHeader) + kEurocRows));
  EXPECT_EQ(euroc.format, TrajectoryFormat::kEuroc);
  EXPECT_THAT(words_of(euroc.losses), testing::ElementsAre("velocities left_out", "biases left_out"));
  expect_by_hand(euroc.trajectory);
  file(folder, "a.times.txt", kTimes);
  const TrajectoryReading kitti = read_trajectory_file(file(folder, "a.csv", kKitti));
  EXPECT_EQ(kitti.format, TrajectoryFormat::kKitti);
  EXPECT_THAT(words_of(kitti.losses), testing::ElementsAre("times given"));
  expect_by_hand(kitti.trajectory);
}

TEST(TrajectoryFormats, ReadEurocsShortRowsAndItsOtherHeader) {
  const fs::path path =
      file(test::temporary_folder(), "basalt.csv",
           "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x "
           "[],q_RS_y [],q_RS_z []\r\n"
           "1.403636579763555584e+18,1.5,-2.25,0.125,0.7071067811865476,0,0,0.7071067811865476\r\n"
           "1403636580013555584, 2, -2, 0.5, 0.5, 0.5, 0.5, 0.5\r\n"
           "1403636580263555584,2.25,-1.5,0.75,0.7071067811865476,0.7071067811865476,0,0\r\n");
  const TrajectoryReading reading = read_trajectory_file(path);
  EXPECT_TRUE(reading.losses.empty());
  expect_by_hand(reading.trajectory);
}

TEST(TrajectoryFormats, AreReadWithAByteOrderMark) {
  const fs::path folder = test::temporary_folder();
  const std::string mark = "\xEF\xBB\xBF";
  expect_by_hand(read_trajectory_file(file(folder, "a.tum", mark + kTum)).trajectory);
  expect_by_hand(read_tum(folder / "a.tum"));
  expect_by_hand(read_trajectory_file(file(folder, "a.csv", mark + kEurocHeader + kEurocRows)).trajectory);
  file(folder, "b.times.txt", mark + kTimes);
  expect_by_hand(read_trajectory_file(file(folder, "b.kitti", mark + kKitti)).trajectory);
}

TEST(TrajectoryFormats, ReadTimesBeforeTheClockBegan) {
  const fs::path path =
      file(test::temporary_folder(), "a.csv",
           "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
           "q_RS_z []\n"
           "-950000000,1,2,3,1,0,0,0\n-5e8,1,2,3,1,0,0,0\n0,1,2,3,1,0,0,0\n");
  const Trajectory trajectory = read_trajectory_file(path).trajectory;
  ASSERT_EQ(trajectory.size(), 3u);
  EXPECT_EQ(trajectory[0].timestamp.ns, -950'000'000);
  EXPECT_EQ(trajectory[1].timestamp.ns, -500'000'000);
}

TEST(TrajectoryFormats, WriteWhatWasWrittenByHand) {
  const fs::path folder = test::temporary_folder();
  write_trajectory_as(folder / "out.tum", by_hand(), TrajectoryFormat::kTum);
  EXPECT_EQ(read_file(folder / "out.tum"), kTum);
  write_trajectory_as(folder / "out.csv", by_hand(), TrajectoryFormat::kEuroc);
  EXPECT_EQ(read_file(folder / "out.csv"), std::string(kEurocHeader) + kEurocRows);
  EXPECT_THAT(words_of(trajectory_losses(folder / "out.csv", TrajectoryFormat::kEuroc)),
              testing::ElementsAre("velocities assumed", "biases assumed"));
  write_trajectory_as(folder / "out.kitti", by_hand(), TrajectoryFormat::kKitti);
  const std::string kitti = read_file(folder / "out.kitti");
  EXPECT_THAT(kitti, HasSubstr("\n0 0 1 2 1 0 0 -2 0 1 0 0.5\n"));  // whose quaternion is exact
  EXPECT_EQ(read_file(folder / "out.times.txt"),
            "1403636579.763555584\n1403636580.013555584\n1403636580.263555584\n");
  const auto losses = trajectory_losses(folder / "out.kitti", TrajectoryFormat::kKitti);
  EXPECT_THAT(words_of(losses), testing::ElementsAre("times converted"));
  EXPECT_EQ(losses.front().value, (folder / "out.times.txt").string());
}

/// Poses with all digits, and a quaternion whose w is negative.
Trajectory of_many_digits() {
  Trajectory trajectory;
  for (int i = 0; i < 20; ++i) {
    const double a = 0.3 * i;
    trajectory.push_back(
        {{1700000000123456789 + 33333333 * i},
         {Eigen::Quaterniond(std::cos(a), std::sin(a) / 3, -2 * std::sin(a) / 3, 2 * std::sin(a) / 3),
          {std::exp(a), -1e-7 / (i + 3), 1e5 + a}}});
  }
  return trajectory;
}

TEST(TrajectoryFormats, KeepEveryDigit) {
  const fs::path folder = test::temporary_folder();
  const Trajectory trajectory = of_many_digits();
  write_trajectory_as(folder / "a.tum", trajectory, TrajectoryFormat::kTum);
  write_trajectory_as(folder / "b.csv", read_trajectory(folder / "a.tum"), TrajectoryFormat::kEuroc);
  write_trajectory_as(folder / "c.kitti", read_trajectory(folder / "b.csv"), TrajectoryFormat::kKitti);
  const Trajectory euroc = read_trajectory(folder / "b.csv"), kitti = read_trajectory(folder / "c.kitti");
  ASSERT_EQ(euroc.size(), trajectory.size());
  ASSERT_EQ(kitti.size(), trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_EQ(euroc[i].timestamp, trajectory[i].timestamp);
    EXPECT_EQ(euroc[i].pose.translation(), trajectory[i].pose.translation());
    EXPECT_EQ(euroc[i].pose.rotation().coeffs(), trajectory[i].pose.rotation().coeffs());
    EXPECT_EQ(kitti[i].timestamp, trajectory[i].timestamp);
    EXPECT_EQ(kitti[i].pose.translation(), trajectory[i].pose.translation());
    EXPECT_LT((kitti[i].pose.rotation_matrix() - trajectory[i].pose.rotation_matrix()).norm(), 2e-15);
  }
}

/// Time, and the first three rows of the matrix, of each pose.
struct JudgedPose {
  long long time_ns = 0;
  Eigen::Matrix<double, 3, 4> rows;
};

std::vector<JudgedPose> judged(const std::string& arguments) {
  const std::string command =
      fmt::format("{} '{}' {}", test::python_with("numpy"),
                  test::source_path("tests/eval/judge_trajectories.py").string(), arguments);
  std::istringstream lines(test::judge_output(command));
  std::vector<JudgedPose> poses;
  for (JudgedPose pose; lines >> pose.time_ns; poses.push_back(pose))
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) lines >> pose.rows(row, column);
  return poses;
}

TEST(TrajectoryFormats, AreReadAsEvoReadsThem) {
  APRILTRACK_NEED_JUDGE(test::python_judge("numpy", "python3-numpy"));
  const fs::path folder = test::temporary_folder();
  for (const Trajectory& trajectory : {by_hand(), of_many_digits()}) {
    for (const TrajectoryFormatInfo& info : trajectory_formats()) {
      const fs::path path = folder / fmt::format("t{}", info.ending);
      write_trajectory_as(path, trajectory, info.format);
      const auto poses =
          judged(fmt::format("{} '{}' '{}'", info.name, path.string(), kitti_times_file(path).string()));
      ASSERT_EQ(poses.size(), trajectory.size()) << info.name;
      for (std::size_t i = 0; i < poses.size(); ++i) {
        EXPECT_EQ(poses[i].time_ns, trajectory[i].timestamp.ns) << info.name;
        const Eigen::Matrix<double, 3, 4> expected = trajectory[i].pose.matrix().topRows<3>();
        EXPECT_LT((poses[i].rows - expected).norm(), 2e-15) << info.name << " " << i;
      }
    }
  }
}

TEST(TrajectoryFormats, FindKittisTimes) {
  const fs::path folder = test::temporary_folder();
  const fs::path poses = file(folder, "00.txt", kKitti);
  EXPECT_THAT(test::message_of([&] { read_trajectory(poses); }),
              testing::AllOf(HasSubstr("no times"), HasSubstr("00.times.txt"), HasSubstr("--times"),
                             HasSubstr("--rate")));
  const Trajectory by_rate = read_trajectory_file(poses, {.rate_hz = 8.0}).trajectory;
  ASSERT_EQ(by_rate.size(), 3u);
  EXPECT_EQ(by_rate[2].timestamp.ns, 250'000'000);
  file(folder, "times.txt", "0.000000e+00\n1.036224e-01\n2.071618e-01\n");
  EXPECT_EQ(read_trajectory(poses)[1].timestamp.ns, 103'622'400);
  file(folder, "00.times.txt", kTimes);
  expect_by_hand(read_trajectory(poses));
  const fs::path given = file(folder, "given.txt", "5\n6\n7.5\n");
  EXPECT_EQ(read_trajectory_file(poses, {.times = given}).trajectory[2].timestamp.ns, 7'500'000'000);
  file(folder, "00.times.txt", "1\n2\n");
  EXPECT_THAT(test::message_of([&] { read_trajectory(poses); }),
              testing::AllOf(HasSubstr("00.times.txt: has 2 times"), HasSubstr("has 3 poses")));
  file(folder, "00.times.txt", "1\n2 3\n4\n");
  EXPECT_THAT(test::message_of([&] { read_trajectory(poses); }),
              HasSubstr("00.times.txt:2: '2 3' is no time"));
  EXPECT_THAT(test::message_of([&] { read_trajectory_file(file(folder, "a.tum", kTum), {.rate_hz = 8.0}); }),
              HasSubstr("--rate: is of KITTI's poses"));
}

TEST(TrajectoryFormats, NameFileLineAndColumnOfWhatIsWrong) {
  const fs::path folder = test::temporary_folder();
  file(folder, "t.times.txt", "0\n");
  const auto says = [&](const std::string& text, const std::string& words) {
    const fs::path path = file(folder, "t.txt", text);
    EXPECT_THAT(test::message_of([&] { read_trajectory(path); }), HasSubstr(words)) << text;
  };
  const std::string header = kEurocHeader;
  says(header + "1,0,0,0,1,0,0,0\n", "t.txt:2: has 8 fields, the header has 17");
  says(header + "1.5,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n",
       "t.txt:2: timestamp: '1.5' is no time in whole nano");
  says(header + "1,0,x,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n", "t.txt:2: p_RS_R_y: 'x' is not a finite number");
  says(header + "1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n", "length of the quaternion must be 1 (is 0)");
  says(header + "1,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n1,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n",
       "t.txt:3: timestamp 0.000000001 stands in line 2 already");
  // Seconds and w last: the order of TUM, which read by EuRoC's order would be another pose.
  says("timestamp,tx,ty,tz,qx,qy,qz,qw\n1.5,0,0,0,0,0,0,1\n", "its column 2 is 'tx', not p_RS_R_x");
  says("1,0,0,0,1,0,0,0\n", "its first column is '1'");
  says("0 -1 0 1 1 0 0 2 0 0 1 3\n0 -1 0 1 1 0 0 2 0 0 1\n", "t.txt:2: has 11 columns, not the 12");
  says("0 -1 0 1 1 0 0 2 0 nan 1 3\n", "t.txt:1: r32: 'nan' is not a finite number");
  says("0 1 0 1 1 0 0 2 0 0 1 3\n", "t.txt:1: r11 to r33 are no rotation matrix");  // mirrored
  says("0 -2 0 1 2 0 0 2 0 0 2 3\n", "no rotation matrix");                         // scaled
  says("1 0 0 0 0 0 1\n", "has 7 columns, not the 8 of TUM");
  EXPECT_THAT(test::message_of([&] { read_trajectory(folder / "none"); }, ErrorKind::kIo), HasSubstr("none"));
}

TEST(TrajectoryFormats, LeaveNothingHalfWritten) {
  const fs::path folder = test::temporary_folder();
  EXPECT_THROW(write_trajectory_as(folder / "missing" / "a.csv", by_hand(), TrajectoryFormat::kEuroc), Error);
  EXPECT_THROW(
      write_trajectory_as(folder / "b.csv", {{{2}, Pose()}, {{1}, Pose()}}, TrajectoryFormat::kEuroc),
      MisuseError);
  EXPECT_FALSE(fs::exists(folder / "b.csv"));
}

TEST(TrajectoryFormats, ASinglePoseAndNoneAreWritten) {
  const fs::path folder = test::temporary_folder();
  for (const TrajectoryFormatInfo& info : trajectory_formats()) {
    const fs::path path = folder / fmt::format("one{}", info.ending);
    write_trajectory_as(path, {by_hand().front()}, info.format);
    EXPECT_EQ(read_trajectory(path).size(), 1u) << info.name;
  }
  write_trajectory_as(folder / "no.csv", {}, TrajectoryFormat::kEuroc);
  EXPECT_TRUE(read_trajectory(folder / "no.csv").empty());
  EXPECT_EQ(read_file(folder / "no.csv"), kEurocHeader);
}

TEST(TrajectoryFormats, TellFormatsByNamesAndEndings) {
  EXPECT_EQ(trajectory_format_of_ending("a/b.tum"), TrajectoryFormat::kTum);
  EXPECT_EQ(trajectory_format_of_ending("b.csv"), TrajectoryFormat::kEuroc);
  EXPECT_EQ(trajectory_format_of_ending("b.kitti"), TrajectoryFormat::kKitti);
  EXPECT_EQ(trajectory_format_of_ending("run_kitti.txt"), TrajectoryFormat::kKitti);
  EXPECT_EQ(trajectory_format_of_ending("b.txt"), std::nullopt);
  EXPECT_EQ(trajectory_format_named("euroc"), TrajectoryFormat::kEuroc);
  EXPECT_EQ(trajectory_format_named("EuRoC"), std::nullopt);
}

}  // namespace
}  // namespace apriltrack
