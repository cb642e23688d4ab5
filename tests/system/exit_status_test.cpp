// Where it ends before or after the work, with which status: inputs that are missing, outputs that cannot be.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apriltrack/eval/frame_log.h"
#include "one_image.h"
#include "program.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using ExitStatus = OneImage;

TEST_F(ExitStatus, AnInputIsNeverOverwritten) {
  for (const std::string name : {"camera.yaml", "map.yaml"}) {
    const std::string before = read_text(path(name));
    EXPECT_THAT(track({"--output", path(name)}), EndsWith(2, "is an input"));
    EXPECT_EQ(read_text(path(name)), before);
  }
  EXPECT_THAT(calibrate({"--output", path("camera.yaml")}), EndsWith(2, "is an input"));
  EXPECT_THAT(track({"--frames-csv", path("out.tum")}), EndsWith(2, "--frames-csv"));
}

TEST_F(ExitStatus, AnUnwritableOutputIs3BeforeTheWorkIsDone) {
  EXPECT_THAT(run_program({"simulate", "--scene", "single", "--frames", "1", "--output", "/proc/nowhere"}),
              EndsWith(3, "/proc/nowhere"));
  EXPECT_THAT(track({"--output", path("missing/out.tum")}), EndsWith(3, "missing/out.tum"));
  EXPECT_THAT(calibrate({"--output", path("missing/map.yaml")}), EndsWith(3, "missing/map.yaml"));
  EXPECT_THAT(detect({"--output", path("missing/corners.csv")}), EndsWith(3, "missing/corners.csv"));
}

TEST_F(ExitStatus, AFullFolderIs3AndTheWayOutIsForce) {
  EXPECT_THAT(run_program({"simulate", "--scene", "single", "--frames", "1", "--output", path("frames")}),
              EndsWith(3, "frames: is not empty: name a new folder, or give --force"));
}

TEST_F(ExitStatus, AFolderAsOutputIs3) {
  EXPECT_THAT(track({"--output", path("frames")}), EndsWith(3, "is a folder"));
  EXPECT_THAT(calibrate({"--output", path("frames")}), EndsWith(3, "is a folder"));
}

TEST_F(ExitStatus, AFailedRunKeepsTheOldOutput) {
  write_text(path("out.tum"), "old\n");
  write_text(path("new_map.yaml"), "old\n");
  EXPECT_EQ(track().status, 1);
  EXPECT_EQ(calibrate().status, 1);
  EXPECT_EQ(read_text(path("out.tum")), "old\n");
  EXPECT_EQ(read_text(path("new_map.yaml")), "old\n");
}

TEST_F(ExitStatus, AFailureAnswersMachinesToo) {
  const auto error_of = [](const ProgramRun& run) { return nlohmann::json::parse(run.out).at("error"); };
  struct Expected {
    ProgramRun run;
    int status;
    const char* kind;
  };
  fs::create_directories(path("empty"));
  for (const Expected& one :
       {Expected{run_with({"calibrate", path("frames"), "--json"}, {}), 2, "invalid_input"},
        Expected{run_program({"map", "show", path("none.yaml"), "--json"}), 3, "io"},
        Expected{run_program({"calibrate", "--no-such-option", "--json"}), 2, "invalid_input"}}) {
    EXPECT_EQ(one.run.status, one.status) << one.run.err;
    ASSERT_FALSE(one.run.out.empty()) << one.run.err;
    EXPECT_EQ(error_of(one.run)["kind"], one.kind);
    EXPECT_EQ(error_of(one.run)["status"], one.status);
    EXPECT_NE(one.run.err.find(error_of(one.run)["message"].get<std::string>()), std::string::npos);
  }
  const ProgramRun none = track();
  EXPECT_EQ(none.status, 1);
  EXPECT_EQ(none.out, "") << "nobody asked";
}

TEST_F(ExitStatus, AReaderThatGoesAwayLeavesNoFileHalfWritten) {
  write_text(path("d.csv"), "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n");
  const ProgramRun run = run_program_without_reader({"map", "show", path("map.yaml")});
  EXPECT_EQ(run.status, 3);
  const ProgramRun simulated = run_program_without_reader(
      {"simulate", "--scene", "single", "--frames", "1", "--output", path("film")});
  EXPECT_EQ(simulated.status, 3) << "its answer was not read";
  EXPECT_TRUE(fs::exists(path("film/camera.yaml")));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_))
    EXPECT_NE(entry.path().extension(), ".new") << entry.path();
}

TEST_F(ExitStatus, MissingInputsAre3) {
  fs::remove_all(path("frames"));
  EXPECT_THAT(track(), EndsWith(3, "frames"));
  fs::create_directories(path("frames"));
  EXPECT_THAT(track(), EndsWith(3, "frames"));  // an empty folder
}

TEST_F(ExitStatus, MissingMapOrCameraIs3) {
  EXPECT_THAT(track({"--map", path("nowhere.yaml")}), EndsWith(3, "nowhere.yaml"));
  EXPECT_THAT(track({"--camera", path("nowhere.yaml")}), EndsWith(3, "nowhere.yaml"));
  EXPECT_THAT(run_program({"evaluate", "--truth", path("nowhere.tum"), "--estimate", path("x.tum")}),
              EndsWith(3, "nowhere.tum"));
  EXPECT_THAT(run_program({"map", "show", path("nowhere.yaml")}), EndsWith(3, "nowhere.yaml"));
}

TEST_F(ExitStatus, NoTagSeenIs1AndSaysWhatToDo) {
  EXPECT_THAT(track(), EndsWith(1, "no tag of family tag36h11 in any of 1 frames"));
  EXPECT_THAT(track(), EndsWith(1, "is this the family that is printed"));
  EXPECT_THAT(calibrate(), EndsWith(1, "no tags were seen in 1 frames; check the tag family"));
  EXPECT_THAT(detect(), EndsWith(1, "no tag of family tag36h11 in any of 1 frames; try"));
  EXPECT_FALSE(fs::exists(path("out.tum")));
  EXPECT_FALSE(fs::exists(path("new_map.yaml")));
  EXPECT_FALSE(fs::exists(path("corners.csv")));
}

TEST_F(ExitStatus, NoPoseInAnyFrameIs1AndLeavesTheFrameLogThatTheErrorNames) {
  write_image(path("frames/2000000000.pgm"), 160, 120);
  write_text(path("frames/3000000000.pgm"), "no picture");
  for (const char* method : {"blur", "paper", "pnp"}) {
    const std::string log = path(std::string(method) + ".csv");
    const std::string status = "(each frame's status: " + log + ")";
    EXPECT_THAT(track({"--method", method, "--frames-csv", log}), EndsWith(1, status));
    EXPECT_FALSE(fs::exists(path("out.tum")));
    std::vector<std::string> statuses;
    for (const FrameLogRow& row : read_frame_log(log)) statuses.push_back(row.status);
    EXPECT_THAT(statuses, testing::ElementsAre("lost", "lost", "unreadable")) << method;
  }
  EXPECT_THAT(track({"--frames-csv", "/dev/stdout"}).out, testing::HasSubstr("1000000000,lost,"));
}

TEST_F(ExitStatus, NoPoseInAnyFrameKeepsTheFrameLogOfARunThatGavePoses) {
  const std::string log = path("log.csv");
  std::vector<FrameLogRow> with_pose(2);
  with_pose[0].status = "lost";
  with_pose[1].status = "detected";
  with_pose[1].pose = Pose();
  write_frame_log(log, with_pose);
  const std::string before = read_text(log);
  const std::string kept = "(" + log + " is kept: of a run with poses, or no frame log)";
  EXPECT_THAT(track({"--frames-csv", log}), EndsWith(1, kept));
  EXPECT_EQ(read_text(log), before);
  write_text(log, "something else\n");
  EXPECT_THAT(track({"--frames-csv", log}), EndsWith(1, kept));
  EXPECT_EQ(read_text(log), "something else\n");
}

TEST_F(ExitStatus, NoPoseInAnyFrameReplacesTheFrameLogOfARunThatGaveNone) {
  const std::string log = path("log.csv");
  EXPECT_EQ(track({"--frames-csv", log}).status, 1);
  write_image(path("frames/2000000000.pgm"), 160, 120);
  EXPECT_THAT(track({"--frames-csv", log}), EndsWith(1, "(each frame's status: " + log + ")"));
  EXPECT_EQ(read_frame_log(log).size(), 2U);
}

TEST_F(ExitStatus, FramesThatShowNothingAre1AndAskForTheLens) {
  const std::string advice = "each of 2 frames is of one brightness; is the lens covered, or the exposure";
  const auto write_even = [&](const char* name, char grey) {
    write_text(path(name), "P5\n160 120\n255\n" + std::string(160 * 120, grey));
  };
  for (const char grey : {'\x00', '\xFF'}) {
    write_even("frames/1000000000.pgm", grey);
    write_even("frames/2000000000.pgm", grey);
    for (const ProgramRun& run : {track(), track({"--method", "pnp"}), calibrate(), detect()}) {
      EXPECT_THAT(run, EndsWith(1, advice));
      EXPECT_THAT(run.err, testing::Not(testing::HasSubstr("family")));
    }
  }
  write_image(path("frames/3000000000.pgm"), 160, 120);
  for (const ProgramRun& run : {track(), calibrate(), detect()}) EXPECT_THAT(run, EndsWith(1, "family"));
}

TEST_F(ExitStatus, NoTagSeenInLargeImagesAdvisesASmallerSearch) {
  const std::string advice = "try --decimate 4";
  EXPECT_THAT(track().err, testing::Not(testing::HasSubstr(advice)));
  write_text(path("camera.yaml"), replaced(kGoodCamera, "[160, 120]", "[2600, 120]"));
  write_image(path("frames/1000000000.pgm"), 2600, 120);
  EXPECT_THAT(track(), EndsWith(1, advice));
  EXPECT_THAT(track({"--decimate", "4"}).err, testing::Not(testing::HasSubstr(advice)))
      << "it is done already";
}

}  // namespace
}  // namespace apriltrack::test
