// Bags, and names that would be read as pictures, videos or bags, are no place for an output.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "apriltrack/bag/mcap_writer.h"
#include "apriltrack/io/staged_files.h"
#include "bag/bag_writers.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

class KeptFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    run_for_json({"simulate", "--scene", "single", "--frames", "4", "--output", path("room")});
  }

  std::string path(const std::string& name) const { return folder_ / name; }
  std::vector<TestMessage> messages(Wire wire) const {
    return {{"/imu", "sensor_msgs/Imu", 1, MessageBytes(wire).header(1).done()}};
  }

  /// One of each kind that others record.
  std::vector<std::string> bags() const {
    write_ros1_bag(path("a.bag"), messages(Wire::kRos1));
    write_mcap(path("a.mcap"), Wire::kCdr, messages(Wire::kCdr));
    write_db3(path("a.db3"), messages(Wire::kCdr));
    fs::copy_file(path("a.bag"), path("by_content"), fs::copy_options::overwrite_existing);
    return {path("a.bag"), path("a.mcap"), path("a.db3"), path("by_content")};
  }

  /// A folder as rosbag2 leaves it; returns its name.
  std::string rosbag2(const std::string& name, bool has_metadata) const {
    fs::create_directories(path(name));
    write_mcap(path(name + "/a_0.mcap"), Wire::kCdr, messages(Wire::kCdr));
    if (has_metadata)
      write_text(path(name + "/metadata.yaml"),
                 "rosbag2_bagfile_information:\n  storage_identifier: mcap\n"
                 "  relative_file_paths: [a_0.mcap]\n");
    return path(name);
  }

  std::vector<std::string> track_room(std::vector<std::string> more) const {
    std::vector<std::string> words = {"track", path("room"), "--method", "pnp", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// Every command that writes a file, writing this one.
  std::vector<std::vector<std::string>> runs_that_write(const std::string& file) const {
    const std::string map = path("room/map.yaml"), camera = path("room/camera.yaml");
    const std::string poses = path("room/truth.tum");
    return {track_room({"--output", file}),
            track_room({"--output", path("o.tum"), "--frames-csv", file}),
            track_room({"--output", path("o.tum"), "--tags-csv", file}),
            track_room({"--output", path("o.tum"), "--report", file}),
            track_room({"--output", file, "--output-format", "mcap"}),
            {"detect", path("room"), "--output", file},
            {"calibrate", path("room"), "--tag-size", "0.16", "--output", file},
            {"map", "convert", map, file, "--to", "wpilib"},
            {"map", "convert", map, file, "--to", "glb"},
            {"map", "show", map, "--report", file},
            {"map", "align", map, map, "--output", file},
            {"map", "merge", map, map, "--output", file},
            {"camera", "convert", camera, file, "--to", "kalibr"},
            {"trajectory", "convert", poses, file, "--to", "tum"}};
  }

  fs::path folder_;
};

TEST_F(KeptFiles, NoBagIsReplacedByAnyCommand) {
  for (const std::string& bag : bags()) {
    const std::string before = read_text(bag);
    for (const auto& words : runs_that_write(bag)) {
      EXPECT_THAT(run_program(words), EndsWith(2, "is a bag, which this would replace"))
          << bag << ": " << words[0] << " " << words[1];
      ASSERT_EQ(read_text(bag), before) << words[0] << " " << words[1];
    }
  }
}

TEST_F(KeptFiles, NothingOfAFolderThatIsABagIsReplacedOrAdded) {
  for (const bool has_metadata : {true, false}) {
    const std::string bag = rosbag2(has_metadata ? "closed" : "cut_off", has_metadata);
    const std::string before = read_text(bag + "/a_0.mcap");
    const std::vector<std::string> run = {
        "track",   bag,       "--camera", path("room/camera.yaml"), "--map", path("room/map.yaml"),
        "--quiet", "--output"};
    for (const char* name : {"a_0.mcap", "new.mcap", "metadata.yaml", "new.db3"}) {
      std::vector<std::string> words = run;
      words.push_back(bag + "/" + name);
      EXPECT_THAT(run_program(words), EndsWith(2, "an input of this run")) << name;
    }
    EXPECT_THAT(run_program({"calibrate", bag, "--tag-size", "0.16", "--output", bag + "/metadata.yaml"}),
                EndsWith(2, "an input of this run"));
    EXPECT_EQ(read_text(bag + "/a_0.mcap"), before);
    EXPECT_EQ(names_in(bag).size(), has_metadata ? 2U : 1U);
    // Of another run, too.
    EXPECT_THAT(run_program(track_room({"--output", bag + "/metadata.yaml"})),
                EndsWith(2, "is a recording's own file"));
  }
}

TEST_F(KeptFiles, AnMcapOfOursIsReplacedByTheNextRunAlone) {
  const std::string mcap = path("run.mcap");
  ASSERT_EQ(mcap_library(path("nothing.mcap")), std::nullopt);
  ASSERT_EQ(run_program(track_room({"--output", mcap})).status, 0);
  EXPECT_TRUE(mcap_library(mcap).value_or("").starts_with("apriltrack "));
  EXPECT_EQ(run_program(track_room({"--output", mcap})).status, 0);
  EXPECT_THAT(run_program({"map", "convert", path("room/map.yaml"), mcap, "--to", "wpilib"}),
              EndsWith(2, "is a bag"));
  // Another's, whose library is told by the same field.
  write_mcap(mcap, Wire::kCdr, messages(Wire::kCdr));
  EXPECT_THAT(run_program(track_room({"--output", mcap})), EndsWith(2, "is a bag"));
}

TEST_F(KeptFiles, OtherBinaryFilesAreKeptAndScenesReplaced) {
  const std::string archive = path("calibration.npz"), scene = path("scene.glb");
  const std::string before("PK\3\4\0\0somebody's", 16);
  write_text(archive, before);
  for (const auto& words : runs_that_write(archive))
    EXPECT_THAT(run_program(words), EndsWith(2, "is a file of binary data")) << words[0] << " " << words[1];
  EXPECT_EQ(read_text(archive), before);
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(run_program({"map", "convert", path("room/map.yaml"), scene}).status, 0) << "by its like";
}

TEST_F(KeptFiles, NamesOfPicturesVideosAndBagsAreRefused) {
  for (const char* name : {"room/frames/x.png", "x.PNG", "x.jpeg", "x.mkv", "x.bag", "x.db3"}) {
    for (const auto& words : runs_that_write(path(name))) {
      EXPECT_THAT(run_program(words), EndsWith(2, "and what is written here is none"))
          << name << ": " << words[0] << " " << words[1];
      ASSERT_FALSE(fs::exists(path(name))) << words[0] << " " << words[1];
    }
  }
  EXPECT_THAT(run_program(track_room({"--output", path("x.mcap"), "--output-format", "tum"})),
              EndsWith(2, "ends in .mcap as a bag does"));
}

}  // namespace
}  // namespace apriltrack::test
