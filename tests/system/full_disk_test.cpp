// Every output of every command on a disk that becomes full while it is written: the status is 3, the file is
// named with the system's reason, and nothing is left of it under any name.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

std::set<std::string> all_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) names.insert(entry.path().string());
  return names;
}

class FullDisk : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    room_ = (folder_ / "room").string();
    run_for_json({"simulate", "--scene", "room-gentle", "--frames", "20", "--seed", "3", "--output", room_});
    before_ = all_in(folder_);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// max_bytes: what a file may grow to.
  void expect_nothing_left(const std::vector<std::string>& words, std::size_t max_bytes,
                           const std::string& named) {
    const ProgramRun run = run_program_on_full_disk(words, max_bytes);
    EXPECT_EQ(run.status, 3) << named << ": " << run.err;
    if (max_bytes >= kMessageFits) {  // what catches stderr is a file on that disk, too
      EXPECT_NE(run.err.find("error: " + path(named)), std::string::npos) << run.err;
      EXPECT_NE(run.err.find("File too large"), std::string::npos) << run.err;
      ++num_messages_;
    }
    EXPECT_EQ(all_in(folder_), before_) << named;
    ++num_checked_;
  }

  fs::path folder_;
  std::string room_;
  std::set<std::string> before_;
  int num_checked_ = 0;
  int num_messages_ = 0;  ///< Of them, with what was said.
  static constexpr std::size_t kMessageFits = 600;
};

TEST_F(FullDisk, LeavesNothingOfASimulatedRecording) {
  const std::vector<std::string> words = {"simulate", "--scene",  "room-gentle", "--frames",
                                          "4",        "--output", path("film")};
  for (const std::size_t max_bytes : {10, 200, 1000, 3000, 20'000})
    expect_nothing_left(words, max_bytes, "film");
  EXPECT_EQ(num_checked_, 5);
}

TEST_F(FullDisk, LeavesAFolderThatWasThereBefore) {
  fs::create_directories(folder_ / "film");
  before_ = all_in(folder_);
  expect_nothing_left({"simulate", "--scene", "room-gentle", "--frames", "4", "--output", path("film")}, 3000,
                      "film");
  EXPECT_TRUE(fs::is_directory(folder_ / "film"));
}

TEST_F(FullDisk, LeavesNothingOfPrintedPages) {
  const std::vector<std::string> words = {"map", "print", room_ + "/map.yaml", "--output", path("pages")};
  expect_nothing_left(words, 700, "pages");
  fs::create_directories(folder_ / "pages");
  before_ = all_in(folder_);
  expect_nothing_left(words, 700, "pages");
  EXPECT_EQ(num_messages_, 2);
}

TEST_F(FullDisk, LeavesNothingOfWhatTrackAndDetectWrite) {
  expect_nothing_left({"detect", room_, "--output", path("d.csv")}, 700, "d.csv");
  const std::vector<std::string> track = {"track", room_, "--method", "pnp", "--output", path("t.tum")};
  const auto with = [&](const std::string& option, const std::string& file) {
    std::vector<std::string> words = track;
    words.insert(words.end(), {option, path(file)});
    return words;
  };
  expect_nothing_left(track, 700, "t.tum");
  expect_nothing_left(with("--frames-csv", "f.csv"), 2'000, "f.csv");
  expect_nothing_left(with("--report", "r.html"), 15'000, "r.html");
  for (const std::size_t max_bytes : {10, 4'000, 20'000})
    expect_nothing_left(with("--video", "v.mp4"), max_bytes, "v.mp4");
  EXPECT_EQ(num_checked_, 7);
  EXPECT_EQ(num_messages_, 6);
}

TEST_F(FullDisk, LeavesNothingOfWhatCalibrateWrites) {
  std::vector<std::string> words = {"calibrate", room_, "--tag-size", "0.16", "--output", path("m.yaml")};
  expect_nothing_left(words, 500, "m");
  words.insert(words.end(), {"--report", path("r.html")});
  expect_nothing_left(words, 25'000, "r.html");
}

TEST_F(FullDisk, LeavesNothingOfMapsAndCamerasInAnyFormat) {
  for (const std::string format : {"apriltrack", "wpilib", "limelight", "apriltag_ros", "apriltag_ros2",
                                   "tagslam", "aruco", "gltf", "glb", "urdf", "sdf", "g2o"})
    expect_nothing_left({"map", "convert", room_ + "/map.yaml", path("out." + format), "--to", format}, 100,
                        "out." + format);
  for (const std::string format : {"kalibr", "ros", "opencv", "photonvision", "mrcal", "colmap"})
    expect_nothing_left({"camera", "convert", room_ + "/camera.yaml", path("out." + format), "--to", format},
                        30, "out." + format);
  expect_nothing_left({"map", "convert", room_ + "/map.yaml", path("model"), "--to", "colmap"}, 10, "model");
  EXPECT_EQ(num_checked_, 19);
  expect_nothing_left({"map", "convert", room_ + "/map.yaml", path("out.gltf")}, 700, "out.gltf");
  EXPECT_EQ(num_messages_, 1);
}

}  // namespace
}  // namespace apriltrack::test
