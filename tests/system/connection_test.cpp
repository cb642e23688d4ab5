// Which tags `calibrate` puts into one map: those that a chain of common frames joins, and no others.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "apriltrack/tags/tag_map.h"
#include "filmed_wall.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

// Ids 0, 1, 2 are filmed together, 10 and 11 together, 20 alone.
class Connection : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    write_text(path("camera.yaml"), pinhole_entry("cam0"));
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Each group of tags is filmed by itself, ten frames long.
  void film(const std::vector<std::vector<int>>& groups) const {
    std::string csv = kDetectionsHeader;
    long long time_ns = 0;
    for (const auto& group : groups) {
      for (int view = 0; view < 10; ++view) {
        time_ns += 100'000'000;
        for (const int id : group) csv += wall_row(time_ns, camera_from_wall(view), id);
      }
    }
    write_text(path("d.csv"), csv);
  }

  std::vector<std::string> words(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"calibrate", "--detections",      path("d.csv"),
                                    "--camera",  path("camera.yaml"), "--tag-size",
                                    "0.16",      "--output",          path("map.yaml")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  fs::path folder_;
};

std::set<int> ids_of(const TagMap& map) {
  std::set<int> ids;
  for (const MapTag& tag : map.tags) ids.insert(tag.key.id);
  return ids;
}

TEST_F(Connection, NoTwoTagsTogetherIs1AndWritesNothing) {
  film({{0}, {1}, {20}});
  const ProgramRun run = run_program(words({}));
  EXPECT_THAT(run, EndsWith(1, "no two tags connect (seen: tag36h11/0"));
  EXPECT_THAT(run, EndsWith(1, "shares some frames with another"));  // what to do
  for (const char* file : {"map.yaml", "map.detections.csv"}) EXPECT_FALSE(fs::exists(path(file))) << file;
}

TEST_F(Connection, OneTagAloneIs1AndAsksForMore) {
  film({{0}});
  EXPECT_THAT(run_program(words({})), EndsWith(1, "a map needs at least two tags"));
}

TEST_F(Connection, TheLargestPartIsTheMapAndAllOthersAreNamed) {
  film({{10, 11}, {0, 1, 2}, {20}});
  const ProgramRun run = run_program(words({}));
  EXPECT_THAT(run, EndsWith(0, "warning: a part of its own, not in the map: tag36h11/10"));
  EXPECT_THAT(run, EndsWith(0, "warning: left out: tag36h11/20: never seen together with another tag"));
  const TagMap map = read_tag_map(path("map.yaml"));
  EXPECT_EQ(ids_of(map), (std::set<int>{0, 1, 2}));
  expect_distances_of_wall(map);
}

TEST_F(Connection, ObservationsOfAnEarlierRunAreReplaced) {
  film({{0, 1, 2}});
  write_text(path("map.detections.csv"), "of an earlier run\n");
  EXPECT_EQ(run_program(words({})).status, 0);
  const std::string observations = read_text(path("map.detections.csv"));
  std::string last = wall_row(1'000'000'000, camera_from_wall(9), 2);
  last.pop_back();
  EXPECT_THAT(observations, ::testing::HasSubstr(last));
  EXPECT_THAT(observations, ::testing::Not(::testing::HasSubstr("earlier")));
}

TEST_F(Connection, AFailedRunKeepsTheOldMapWithItsObservations) {
  film({{0, 1, 2}});
  write_text(path("map.detections.csv"), "old\n");
  write_text(path("map.yaml"), "old\n");
  fs::create_directories(path("parts"));
  fs::create_symlink("/dev/full",
                     path("parts/part_1.yaml"));  // written after the observations, before the map
  EXPECT_THAT(run_program(words({"--parts", path("parts")})), EndsWith(3, "part_1.yaml"));
  EXPECT_EQ(read_text(path("map.detections.csv")), "old\n");
  EXPECT_EQ(read_text(path("map.yaml")), "old\n");
  EXPECT_FALSE(fs::exists(path("map.detections.csv.new")));
}

TEST_F(Connection, ObservationsThatAreTheInputStayAsTheyAre) {
  film({{0, 1, 2}});
  fs::rename(path("d.csv"), path("map.detections.csv"));
  const std::string before = read_text(path("map.detections.csv"));
  auto again = words({});
  again[2] = path("map.detections.csv");
  EXPECT_EQ(run_program(again).status, 0);
  EXPECT_EQ(read_text(path("map.detections.csv")), before);
}

TEST_F(Connection, ObservationsNeverGoToOneOfSeveralInputs) {
  film({{0, 1, 2}});
  fs::copy(path("d.csv"), path("map.detections.csv"));
  EXPECT_THAT(run_program(words({"--detections", path("map.detections.csv")})),
              EndsWith(2, "map.detections.csv', which is one of several --detections"));
  EXPECT_FALSE(fs::exists(path("map.yaml")));
}

TEST_F(Connection, NothingGoesBesideAMapThatIsNoFile) {
  film({{0, 1, 2}});
  fs::create_symlink("/dev/null", path("map.yaml"));
  write_text(path("map.camera.yaml"), "somebody's\n");  // and no word of it
  const std::set<std::string> before = names_in(folder_);
  const nlohmann::json summary = run_for_json(words({}));
  EXPECT_EQ(names_in(folder_), before);
  EXPECT_FALSE(summary.contains("observations"));
  EXPECT_EQ(summary["warnings"].dump().find("map.camera.yaml"), std::string::npos) << summary["warnings"];

  auto to_stdout = words({});
  to_stdout.back() = "/dev/stdout";
  const ProgramRun run = run_program(to_stdout);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("observations: \"not written\""), std::string::npos) << run.out;
  EXPECT_NE(run.err.find("residual"), std::string::npos) << "the summary is no part of the map: " << run.err;
  write_text(path("piped.yaml"), run.out);
  EXPECT_EQ(read_tag_map(path("piped.yaml")).tags.size(), 3u);
  EXPECT_FALSE(fs::exists("/dev/stdout.detections.csv"));
}

TEST_F(Connection, PartsOfAnEarlierRunAreTold) {
  film({{0, 1, 2}});
  write_text(path("parts/part_2.yaml"), "of an earlier run\n");
  EXPECT_THAT(run_program(words({"--parts", path("parts")})),
              EndsWith(0, "part_2.yaml is of an earlier run"));
}

TEST_F(Connection, OptionsForImagesAreRefusedBesideDetections) {
  film({{0, 1, 2}});
  int checked = 0;
  for (const auto& [option, value] : std::map<std::string, std::string>{{"--step", "2"},
                                                                        {"--max-frames", "3"},
                                                                        {"--rate", "30"},
                                                                        {"--family", "tag25h9"},
                                                                        {"--decimate", "2"}}) {
    EXPECT_THAT(run_program(words({option, value})),
                EndsWith(2, option + ": is for images and would change nothing with --detections"));
    ++checked;
  }
  EXPECT_EQ(checked, 5);
  write_text(path("options.yaml"), "step: 2\n");
  EXPECT_THAT(run_program(words({"--config", path("options.yaml")})), EndsWith(2, "--step: is for images"));
  const std::vector<std::string> track = {"track",          "--detections",      path("d.csv"),
                                          "--camera",       path("camera.yaml"), "--map",
                                          path("map.yaml"), "--output",          path("out.tum")};
  for (const std::string option : {"--rate", "--decimate", "--min-margin", "--max-hamming"}) {
    auto all = track;
    all.insert(all.end(), {option, "1"});
    EXPECT_THAT(run_program(all), EndsWith(2, option + ": is for images"));
  }
}

TEST_F(Connection, ARollingShutterIsWarnedOfWithItsCost) {
  film({{0, 1, 2}});
  write_text(path("camera.yaml"), pinhole_entry("cam0") + "  line_delay: 2.0e-5\n");
  const auto all = words({"--json"});
  const ProgramRun run = run_program(all);
  // 480 rows of 20 us are 9.6 ms, half of which is 1.44 px at 300 px/s.
  EXPECT_THAT(run, EndsWith(0, "warning: camera 'cam0' has a rolling shutter (line_delay 20 us)"));
  EXPECT_THAT(run, EndsWith(0, "moves in 4.8 ms (at 10 px a frame and 30 Hz: 1.4 px)"));
  EXPECT_THAT(nlohmann::json::parse(run.out)["warnings"].dump(), ::testing::HasSubstr("rolling shutter"));
  EXPECT_EQ(run.err.find("rolling shutter"), run.err.rfind("rolling shutter")) << "told more than once";
}

TEST_F(Connection, CornersOutsideThePictureAreWarnedOfOnceWithTheirLine) {
  film({{0, 1, 2}});
  std::string csv = read_text(path("d.csv"));
  csv += "2000000000,cam0,tag36h11,0,900.5,640,930,640,930,610,900,610\n";  // of one frame in eleven
  write_text(path("d.csv"), csv);
  const ProgramRun run = run_program(words({}));
  EXPECT_THAT(run,
              EndsWith(0,
                       "warning: 1 of 11 frames of camera 'cam0' have corners far outside its pictures, as "
                       "misread tags and pictures of another size have: " +
                           path("d.csv") +
                           ":32: corner 0 of tag36h11/0 lies at (900.5, 640.0), and camera 'cam0' is "
                           "calibrated for 640 x 480 pixels"));
  EXPECT_EQ(run.err.find("far outside"), run.err.rfind("far outside")) << run.err;
}

TEST_F(Connection, SizesOfTagsThatWereNeverSeenAreToldWithTheirLines) {
  film({{0, 1, 2}});
  const auto run_with_sizes = [&](const std::string& sizes) {
    write_text(path("sizes.yaml"), "default: 0.16\nsizes:\n" + sizes);
    return run_program(words({"--tag-sizes", path("sizes.yaml")}));
  };
  EXPECT_THAT(
      run_with_sizes("  0: 0.16\n  7: 0.1\n  tag36h11/1: 0.16\n  tag25h9/1: 0.2\n"),
      EndsWith(0, "warning: --tag-sizes names tags that were never seen, whose sizes change nothing: 7 (" +
                      path("sizes.yaml") + ":4), tag25h9/1 (" + path("sizes.yaml") + ":6); is an id"));
  const ProgramRun all_seen = run_with_sizes("  0: 0.16\n  tag36h11/1: 0.16\n");
  EXPECT_EQ(all_seen.status, 0) << all_seen.err;
  EXPECT_EQ(all_seen.err.find("never seen"), std::string::npos) << all_seen.err;
  std::string many;
  for (int id = 100; id < 112; ++id) many += "  " + std::to_string(id) + ": 0.1\n";
  EXPECT_THAT(run_with_sizes(many), EndsWith(0, "sizes.yaml:12) and 2 more; is an id"));
}

TEST_F(Connection, TheHeldTagChoosesThePart) {
  film({{10, 11}, {0, 1, 2}});
  const ProgramRun run = run_program(words({"--held-tag", "11"}));
  EXPECT_THAT(run, EndsWith(0, "not in the map: tag36h11/0"));
  const TagMap map = read_tag_map(path("map.yaml"));
  EXPECT_EQ(ids_of(map), (std::set<int>{10, 11}));
  EXPECT_EQ(map.tags.back().T_map_tag.translation().norm(), 0.0);  // 11: at the origin
}

TEST_F(Connection, PartsAreWrittenAsMapsOfTheirOwn) {
  film({{10, 11}, {0, 1, 2}, {20}});
  const nlohmann::json told = run_for_json(words({"--parts", path("parts")}));
  EXPECT_EQ(told["part_files"], (nlohmann::json{path("parts/part_1.yaml"), path("parts/part_2.yaml")}));
  EXPECT_EQ(told["left_out"], (nlohmann::json{"tag36h11/20"}));
  EXPECT_EQ(read_text(path("parts/part_1.yaml")), read_text(path("map.yaml")));
  const TagMap second = read_tag_map(path("parts/part_2.yaml"));
  EXPECT_EQ(ids_of(second), (std::set<int>{10, 11}));
  expect_distances_of_wall(second);
  EXPECT_FALSE(fs::exists(path("parts/part_3.yaml")));  // tag 20: no observation supports a place for it
}

}  // namespace
}  // namespace apriltrack::test
