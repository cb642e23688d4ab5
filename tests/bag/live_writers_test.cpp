// Other projects' writers, run here and now where they are installed: what they write today is read as what
// is kept of them in tests/bag/data.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "recording.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

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
  // Debian's own Python sees Debian's packages.
  if (!runs("/usr/bin/python3 -c 'import rosbag, sensor_msgs.msg, geometry_msgs.msg'"))
    GTEST_SKIP() << "python3-rosbag and python3-sensor-msgs are not installed";
  const fs::path folder = temporary_folder();
  const std::string script = source_path("tests/bag/make_fixtures.py").string();
  ASSERT_TRUE(runs("/usr/bin/python3 -B '" + script + "' --ros1 '" + folder.string() + "'"));
  for (const char* name : {"plain.bag", "bz2.bag", "lz4.bag"}) expect_the_recording(folder / name);
}

TEST(LiveWriters, OfMcapAreRead) {
  const char* const modules = std::getenv("APRILTRACK_NODE_MODULES");
  if (!modules || !fs::exists(fs::path(modules) / "node_modules/@mcap/core") ||
      !runs("node --version && zstd -V && lz4 -V"))
    GTEST_SKIP() << "@mcap/core is not installed (APRILTRACK_NODE_MODULES names a folder whose node_modules "
                    "has it), or "
                    "node, zstd or lz4 is not";
  const fs::path folder = temporary_folder();
  const std::string script = source_path("tests/bag/make_fixtures.mjs").string();
  ASSERT_TRUE(runs("node '" + script + "' '" + folder.string() + "'"));
  for (const char* name :
       {"plain.mcap", "lz4.mcap", "zstd.mcap", "ros1_zstd.mcap", "without_chunks.mcap", "without_index.mcap"})
    expect_the_recording(folder / name);
}

}  // namespace
}  // namespace apriltrack::test
