#include "apriltrack/source/bag_poses.h"

#include <gmock/gmock.h>

#include <array>

#include "apriltrack/base/error.h"
#include "bag/bag_writers.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

/// As foxglove/foxglove-sdk has it (schemas/jsonschema/PoseInFrame.json): seconds from 0 on, nanoseconds
/// below 1e9, both whole.
TestMessage foxglove_pose(const std::string& seconds, const std::string& nanoseconds) {
  return {"/pose", "foxglove.PoseInFrame", 1'700'000'000'000'000'000,
          R"({"timestamp": {"sec": )" + seconds + R"(, "nsec": )" + nanoseconds +
              R"(}, "frame_id": "w", "pose": {"position": {"x": 1, "y": -2, "z": 3.5},)"
              R"( "orientation": {"x": 0, "y": 0, "z": 0.6, "w": 0.8}}})"};
}

TEST(FoxglovePoses, HaveTheirTimesToTheNanosecond) {
  const fs::path bag = temporary_folder() / "poses.mcap";
  write_mcap(bag, Wire::kJson,
             {foxglove_pose("0", "0"), foxglove_pose("1700000000", "123456789"),
              foxglove_pose("9223372035", "999999999")});
  const std::vector<BagPose> poses = read_bag_poses(bag.string());
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0].timestamp.ns, 0);
  EXPECT_EQ(poses[1].timestamp.ns, 1'700'000'000'123'456'789);
  EXPECT_EQ(poses[2].timestamp.ns, 9'223'372'035'999'999'999);
  EXPECT_EQ(poses[1].pose.translation(), Eigen::Vector3d(1, -2, 3.5));
}

TEST(FoxglovePoses, AreRefusedWithTimesThatAreNone) {
  const fs::path bag = temporary_folder() / "poses.mcap";
  const std::vector<std::array<std::string, 3>> times = {
      {"1e+300", "0", "timestamp.sec"},     {"9e+18", "5", "timestamp.sec"},
      {"9223372036", "0", "timestamp.sec"}, {"-1", "0", "timestamp.sec"},
      {"0.5", "0", "timestamp.sec"},        {"2", "-5", "timestamp.nsec"},
      {"3", "1.5", "timestamp.nsec"},       {"1", "1000000000", "timestamp.nsec"}};
  for (const auto& [seconds, nanoseconds, field] : times) {
    SCOPED_TRACE(seconds + " s, " + nanoseconds + " ns");
    write_mcap(bag, Wire::kJson, {foxglove_pose(seconds, nanoseconds)});
    try {
      read_bag_poses(bag.string());
      ADD_FAILURE() << "is read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      EXPECT_THAT(error.what(), HasSubstr("poses.mcap /pose message 0"));
      EXPECT_THAT(error.what(), HasSubstr(field + ": must be a whole number from 0 to"));
      EXPECT_THAT(error.what(), HasSubstr("(is " + (field.ends_with("nsec") ? nanoseconds : seconds)));
    }
  }
}

TEST(FoxglovePoses, LeaveOutAMessageThatIsBroken) {
  const fs::path bag = temporary_folder() / "poses.mcap";
  TestMessage torn = foxglove_pose("2", "0");
  torn.bytes.resize(torn.bytes.size() / 2);
  write_mcap(bag, Wire::kJson,
             {foxglove_pose("1", "0"), torn, foxglove_pose("-3", "0"), foxglove_pose("4", "0")});
  std::string told;
  const auto poses = read_bag_poses(bag.string(), {}, [&](LogLevel, std::string_view text) { told = text; });
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[1].timestamp.ns, 4'000'000'000);
  EXPECT_THAT(told, HasSubstr("2 messages are left out; the first: "));
  EXPECT_THAT(told, HasSubstr("poses.mcap /pose message 1"));
}

// Transforms, serialised as tf2_msgs/TFMessage.msg lists them: transforms[] of header, child_frame_id,
// translation, rotation (x y z w).

struct Transform {
  std::string parent, child;
  std::int64_t stamp_ns = 0;
  double x = 0.0;
};

constexpr std::int64_t kStart_ns = 1'700'000'000'250'000'000;

/// At (x, -2, 3.5), turned by a quarter about z.
void add_pose(MessageBytes& bytes, double x) {
  for (const double value : {x, -2.0, 3.5, 0.0, 0.0, 0.7071067811865476, 0.7071067811865476})
    bytes.real(value);
}

void add_header(MessageBytes& bytes, Wire wire, std::int64_t stamp_ns, const std::string& frame) {
  if (wire == Wire::kRos1) bytes.u32(7);
  bytes.u32(static_cast<std::uint64_t>(stamp_ns / 1'000'000'000))
      .u32(static_cast<std::uint64_t>(stamp_ns % 1'000'000'000))
      .text(frame);
}

TestMessage tf_message(Wire wire, const std::vector<Transform>& transforms, const std::string& topic = "/tf",
                       const std::string& type = "tf2_msgs/TFMessage") {
  MessageBytes bytes(wire);
  bytes.u32(transforms.size());
  for (const Transform& one : transforms) {
    add_header(bytes, wire, one.stamp_ns, one.parent);
    bytes.text(one.child);
    add_pose(bytes, one.x);
  }
  return {topic, type, transforms.empty() ? kStart_ns : transforms.front().stamp_ns, bytes.done()};
}

/// The robot's pose of odom in turn with that of its camera; the latter is said twice.
std::vector<TestMessage> robot(Wire wire, const std::string& type = "tf2_msgs/TFMessage") {
  std::vector<TestMessage> messages;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t stamp_ns = kStart_ns + k * 100'000'000;
    const Transform camera = {"base_link", "camera", stamp_ns, 50.0 + k};
    messages.push_back(tf_message(wire, {{"/odom", "/base_link", stamp_ns, 10.0 + k}, camera}, "/tf", type));
    messages.push_back(tf_message(wire, {camera}, "/tf", type));
  }
  messages.push_back(tf_message(wire, {{"map", "odom", kStart_ns, 90.0}}, "/tf_static", type));
  return messages;
}

fs::path bag_of_robot(Wire wire, const std::vector<TestMessage>& messages) {
  const fs::path bag = temporary_folder() / "robot.any";
  if (wire == Wire::kRos1)
    write_ros1_bag(bag, messages);
  else
    write_mcap(bag, wire, messages);
  return bag;
}

void expect_poses(const std::vector<BagPose>& poses, double first_x, int count = 3) {
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(count));
  const Eigen::Matrix3d turn = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  for (int k = 0; k < count; ++k) {
    const BagPose& pose = poses[static_cast<std::size_t>(k)];
    EXPECT_EQ(pose.timestamp.ns, kStart_ns + k * 100'000'000);
    EXPECT_EQ(pose.pose.translation(), Eigen::Vector3d(first_x + k, -2, 3.5));
    EXPECT_LT((pose.pose.rotation_matrix() - turn).norm(), 1e-15);
  }
}

void expect_poses_refused(const fs::path& bag, const BagPoseChoice& choice,
                          const std::vector<std::string>& words) {
  try {
    read_bag_poses(bag.string(), choice);
    ADD_FAILURE() << "is read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    for (const std::string& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
  }
}

TEST(Transforms, OfAPairOfFramesAreRead) {
  for (const Wire wire : {Wire::kRos1, Wire::kCdr, Wire::kCdrBigEndian}) {
    const fs::path bag = bag_of_robot(wire, robot(wire));
    expect_poses(read_bag_poses(bag.string(), {"", "odom:base_link"}), 10.0);
    expect_poses(read_bag_poses(bag.string(), {"/tf", "base_link:camera"}), 50.0);
    expect_poses(read_bag_poses(bag.string(), {"", "map:odom"}), 90.0, 1);
    expect_poses(read_bag_poses(bag.string(), {"/tf_static", ""}), 90.0, 1);
  }
  const fs::path old = bag_of_robot(Wire::kRos1, robot(Wire::kRos1, "tf/tfMessage"));
  expect_poses(read_bag_poses(old.string(), {"", "odom:base_link"}), 10.0);
}

TEST(Transforms, OfSeveralPairsAreListed) {
  const fs::path bag = bag_of_robot(Wire::kCdr, robot(Wire::kCdr));
  const std::string pairs = "base_link:camera (3 poses), map:odom (1 pose), odom:base_link (3 poses)";
  expect_poses_refused(bag, {}, {"3 pairs of frames", pairs, "--transform PARENT:CHILD"});
  expect_poses_refused(bag, {"", "base_link:odom"},
                       {"--transform", "'base_link:odom'", "nor inverted", pairs});
  expect_poses_refused(bag, {"/tf_static", "odom:base_link"},
                       {"'odom:base_link'", "it has: map:odom (1 pose)"});
  expect_poses_refused(bag, {"/nothing", "odom:base_link"},
                       {"no topic '/nothing' with transforms", "/tf_static"});
}

TEST(Transforms, ThatAreCutOffSaySo) {
  std::vector<TestMessage> messages = {tf_message(Wire::kCdr, {{"odom", "base_link", kStart_ns, 1.0}})};
  messages[0].bytes.resize(messages[0].bytes.size() - 9);
  expect_poses_refused(bag_of_robot(Wire::kCdr, messages), {}, {"/tf message 0: ends too soon"});
}

/// A robot's bag has both; what is a trajectory by its type needs no name.
TEST(Transforms, StandBackBehindPoses) {
  std::vector<TestMessage> messages = robot(Wire::kCdr);
  MessageBytes odometry(Wire::kCdr);
  add_header(odometry, Wire::kCdr, kStart_ns, "odom");
  odometry.text("base_link");
  add_pose(odometry, 7.0);
  messages.push_back({"/odom", "nav_msgs/Odometry", kStart_ns, odometry.done()});
  const fs::path bag = bag_of_robot(Wire::kCdr, messages);
  expect_poses(read_bag_poses(bag.string()), 7.0, 1);
  expect_poses(read_bag_poses(bag.string(), {"", "odom:base_link"}), 10.0);
}

// Paths: nav_msgs/Path.msg is a header and poses[] of PoseStamped.

TestMessage path_message(Wire wire, int count, bool has_times = true) {
  MessageBytes bytes(wire);
  add_header(bytes, wire, kStart_ns, "map");
  bytes.u32(static_cast<std::uint64_t>(count));
  for (int k = 0; k < count; ++k) {
    add_header(bytes, wire, has_times ? kStart_ns + k * 100'000'000 : 0, "map");
    add_pose(bytes, 20.0 + k);
  }
  return {"/path", "nav_msgs/Path", kStart_ns + count * 100'000'000, bytes.done()};
}

TEST(Paths, AreReadOfTheLastMessageThatHasPoses) {
  for (const Wire wire : {Wire::kRos1, Wire::kCdr, Wire::kCdrBigEndian}) {
    std::vector<TestMessage> messages;
    for (int count = 1; count <= 3; ++count) messages.push_back(path_message(wire, count));
    TestMessage empty = path_message(wire, 0);
    empty.log_time_ns = kStart_ns + 900'000'000;
    messages.push_back(empty);
    messages.push_back(tf_message(wire, {{"odom", "base_link", kStart_ns, 1.0}}));
    expect_poses(read_bag_poses(bag_of_robot(wire, messages).string()), 20.0);
  }
}

TEST(Paths, ThatAreOnlyPlannedAreRefused) {
  expect_poses_refused(bag_of_robot(Wire::kCdr, {path_message(Wire::kCdr, 2, false)}), {},
                       {"/path message 0", "carry no times", "no trajectory"});
}

}  // namespace
}  // namespace apriltrack::test
