// Other projects' writers, run here and now where they are installed: what they write today is read as what
// is kept of them in tests/bag/data.

#include <gtest/gtest.h>

#include <filesystem>

#include "recording.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

void expect_the_recording(const fs::path& bag) {
  SCOPED_TRACE(bag);
  const auto reader = open_bag(bag);
  const std::vector<Given> given = read_all(*reader);
  const std::vector<Expected> expected = expected_messages();
  ASSERT_EQ(given.size(), expected.size());
  for (std::size_t i = 0; i < given.size(); ++i) EXPECT_TRUE(is_same(given[i], expected[i])) << i;
  EXPECT_EQ(reader->damage(), "");
}

TEST(LiveWriters, OfRos1AreRead) {
  const std::string modules = "rosbag, sensor_msgs.msg, geometry_msgs.msg";
  APRILTRACK_NEED_JUDGE(python_judge(modules, "python3-rosbag, python3-sensor-msgs, python3-geometry-msgs"));
  const fs::path folder = temporary_folder();
  const std::string script = source_path("tests/bag/make_fixtures.py").string();
  ASSERT_TRUE(succeeds(python_with(modules) + " -B '" + script + "' --ros1 '" + folder.string() + "'"));
  for (const char* name : {"plain.bag", "bz2.bag", "lz4.bag"}) expect_the_recording(folder / name);
}

TEST(LiveWriters, OfMcapAreRead) {
  APRILTRACK_NEED_JUDGE(node_judges({"@mcap/core", "@foxglove/rosmsg", "@foxglove/rosmsg-msgs-common",
                                     "@foxglove/rosmsg-serialization", "@foxglove/rosmsg2-serialization"}));
  APRILTRACK_NEED_JUDGE(program_judge("zstd", "zstd"));
  APRILTRACK_NEED_JUDGE(program_judge("lz4", "lz4"));
  const fs::path folder = temporary_folder();
  const std::string script = source_path("tests/bag/make_fixtures.mjs").string();
  ASSERT_TRUE(succeeds(node() + " '" + script + "' '" + folder.string() + "'"));
  for (const char* name :
       {"plain.mcap", "lz4.mcap", "zstd.mcap", "ros1_zstd.mcap", "without_chunks.mcap", "without_index.mcap"})
    expect_the_recording(folder / name);
}

}  // namespace
}  // namespace apriltrack::test
