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
    write_mcap(bag, Wire::kJson, {foxglove_pose("1", "0"), foxglove_pose(seconds, nanoseconds)});
    try {
      read_bag_poses(bag.string());
      ADD_FAILURE() << "is read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      EXPECT_THAT(error.what(), HasSubstr("poses.mcap /pose message 1"));
      EXPECT_THAT(error.what(), HasSubstr(field + ": must be a whole number from 0 to"));
      EXPECT_THAT(error.what(), HasSubstr("(is " + (field.ends_with("nsec") ? nanoseconds : seconds)));
    }
  }
}

}  // namespace
}  // namespace apriltrack::test
