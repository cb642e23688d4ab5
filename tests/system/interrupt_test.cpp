// Ctrl-C: what is done is kept, and no file is left half written.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <thread>

#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/eval/frame_log.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/io/scratch_file.h"
#include "apriltrack/source/image_file.h"
#include "apriltrack/source/sequence_writer.h"
#include "apriltrack/tags/tag_map.h"
#include "program.h"
#include "read_report.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

/// Looks again and again, until it is so or the program has ended.
template <class Condition>
bool wait_until(StartedProgram& program, const Condition& is_so) {
  while (program.is_running()) {
    if (is_so()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return is_so();
}

std::vector<fs::path> images_of(const fs::path& recording) {
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(recording / "frames")) images.push_back(entry.path());
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return std::stoll(a.stem().string()) < std::stoll(b.stem().string());
  });
  return images;
}

/// A recording in which one image is a pipe. A program that comes to it waits, so that Ctrl-C finds it amidst
/// its work on any machine; then the pipe is closed, and that image turns out empty.
class Interrupted : public ::testing::Test {
 protected:
  static constexpr std::size_t kNumFrames = 12;
  static constexpr std::size_t kPipe = 6;
  static constexpr std::size_t kDone = 4;  // one thread reads four frames before it looks at them

  void SetUp() override {
    folder_ = temporary_folder();
    recording_ = folder_ / "room";
    run_for_json({"simulate", "--scene", "room-gentle", "--frames", std::to_string(kNumFrames), "--seed", "3",
                  "--output", recording_});
    make_pipe_of(kPipe);
    fs::create_directories(folder_ / "out");
  }

  void make_pipe_of(std::size_t image) {
    pipe_ = images_of(recording_).at(image);
    fs::remove(pipe_);
    ASSERT_EQ(::mkfifo(pipe_.c_str(), 0600), 0);
  }

  std::string out(const std::string& name) const { return folder_ / "out" / name; }

  /// -1 until the program reads from the pipe.
  int open_pipe() const { return ::open(pipe_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC); }

  ProgramRun interrupt(std::vector<std::string> words) const {
    words.insert(words.end(), {"--threads", "1", "--json"});
    StartedProgram program(words);
    int pipe = -1;
    EXPECT_TRUE(wait_until(program, [&] { return (pipe = open_pipe()) >= 0; })) << "never came to the pipe";
    program.press_ctrl_c();
    if (pipe >= 0) ::close(pipe);
    return program.finish();
  }

  fs::path folder_;
  fs::path recording_;
  fs::path pipe_;
};

TEST_F(Interrupted, TrackKeepsTheFramesUntilThen) {
  const ProgramRun run =
      interrupt({"track", recording_, "--output", out("camera.tum"), "--frames-csv", out("frames.csv")});
  EXPECT_THAT(run, EndsWith(0, "warning: interrupted"));
  const json told = json::parse(run.out);
  EXPECT_EQ(told["interrupted"], true);
  EXPECT_EQ(told["frames"], kDone);
  EXPECT_EQ(names_in(folder_ / "out"), (std::set<std::string>{"camera.tum", "frames.csv"}));
  EXPECT_EQ(read_tum(out("camera.tum")).size(), kDone);
  EXPECT_EQ(read_frame_log(out("frames.csv")).size(), kDone);
}

TEST_F(Interrupted, TrackThatIsTerminatedKeepsTheFramesUntilThen) {
  StartedProgram program(
      {"track", recording_, "--output", out("camera.tum"), "--video", out("film.mp4"), "--threads", "1"});
  int pipe = -1;
  EXPECT_TRUE(wait_until(program, [&] { return (pipe = open_pipe()) >= 0; })) << "never came to the pipe";
  program.terminate();
  if (pipe >= 0) ::close(pipe);
  EXPECT_THAT(program.finish(), EndsWith(0, "warning: interrupted"));
  EXPECT_EQ(names_in(folder_ / "out"), (std::set<std::string>{"camera.tum", "film.mp4"}));
}

TEST_F(Interrupted, TrackThatIsKilledLeavesNothing) {
  {
    StartedProgram program(
        {"track", recording_, "--output", out("camera.tum"), "--video", out("film.mp4"), "--threads", "1"});
    EXPECT_TRUE(wait_until(program, [&] { return open_pipe() >= 0; })) << "never came to the pipe";
  }
  const bool has_nameless_files = ScratchFile(folder_ / "out" / "x").path().string().starts_with("/proc/");
  if (!has_nameless_files) GTEST_SKIP() << "this file system has no files without a name (O_TMPFILE)";
  EXPECT_EQ(names_in(folder_ / "out"), std::set<std::string>());
}

TEST_F(Interrupted, TrackIsScoredOnTheFramesUntilThen) {
  const ProgramRun run =
      interrupt({"track", recording_, "--output", out("camera.tum"), "--report", out("report.html")});
  EXPECT_THAT(run, EndsWith(0, "warning: interrupted"));
  const ReadReport page(out("report.html"));
  EXPECT_THAT(page.row("frames whose truth shows a tag"), ElementsAre(std::to_string(kDone)));
  EXPECT_THAT(page.row("with a pose"), ElementsAre("100.0 %"));
  EXPECT_THAT(page.texts("p"),
              Contains(HasSubstr("figures of the 4 true frames until then, of 12; the 8 after")));
}

TEST_F(Interrupted, DetectKeepsTheFramesUntilThen) {
  const ProgramRun run = interrupt({"detect", recording_, "--output", out("corners.csv")});
  EXPECT_THAT(run, EndsWith(0, "warning: interrupted"));
  EXPECT_EQ(json::parse(run.out)["frames"], kDone);
  EXPECT_EQ(names_in(folder_ / "out"), (std::set<std::string>{"corners.csv"}));
}

TEST_F(Interrupted, CalibrateMakesTheMapOfTheFramesUntilThen) {
  const ProgramRun run =
      interrupt({"calibrate", recording_, "--tag-size", "0.16", "--output", out("map.yaml")});
  EXPECT_THAT(run, EndsWith(0, "warning: interrupted"));
  const json told = json::parse(run.out);
  EXPECT_EQ(told["interrupted"], true);
  EXPECT_EQ(told["frames"], kDone);
  EXPECT_EQ(names_in(folder_ / "out"), (std::set<std::string>{"map.detections.csv", "map.yaml"}));
  const TagMap map = read_tag_map(out("map.yaml"));
  EXPECT_EQ(map.tags.size(), told["tags"].size());
  EXPECT_THAT(map.provenance, Contains(Pair("interrupted", "while reading, after 4 frames")));
}

TEST_F(Interrupted, CalibrateBeforeTheFirstFrameBlamesNoTags) {
  write_text(out("page.html"), "old\n");
  make_pipe_of(0);
  const ProgramRun run = interrupt({"calibrate", recording_, "--tag-size", "0.16", "--output",
                                    out("map.yaml"), "--report", out("page.html")});
  EXPECT_THAT(run, EndsWith(1, "interrupted before the first frame"));
  EXPECT_THAT(run.err, Not(HasSubstr("family")));
  EXPECT_EQ(names_in(folder_ / "out"), (std::set<std::string>{"page.html"}));
  EXPECT_EQ(read_text(out("page.html")), "old\n");
}

// Which take a recording is of is told by all that were to come, not by those that were reached.
TEST_F(Interrupted, CalibrateOfSeveralTakesKeepsThemApart) {
  const fs::path whole = folder_ / "whole";
  fs::create_directories(whole / "frames");
  for (const fs::path& image : images_of(recording_))
    if (image != pipe_) fs::copy(image, whole / "frames");
  const std::string camera = read_text(recording_ / "camera.yaml");
  write_text(folder_ / "rig.yaml",
             camera + "\ncam1" + camera.substr(4) +
                 "\n  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
  const ProgramRun run = interrupt({"calibrate", "cam0=" + whole.string(), "cam0=" + whole.string(),
                                    "cam1=" + recording_.string(), "cam1=" + whole.string(), "--camera",
                                    folder_ / "rig.yaml", "--tag-size", "0.16", "--output", out("map.yaml")});
  EXPECT_THAT(run, EndsWith(0, "warning: interrupted"));
  EXPECT_EQ(json::parse(run.out)["frames"], 2 * (kNumFrames - 1) + kDone);
  std::set<std::int64_t> times_ns[2];
  for (const FrameDetections& frame : read_detections_csv(out("map.detections.csv")))
    times_ns[frame.camera == "cam0" ? 0 : 1].insert(frame.timestamp.ns);
  EXPECT_EQ(times_ns[0].size(), 2 * (kNumFrames - 1));
  EXPECT_EQ(times_ns[1].size(), kDone);
  EXPECT_TRUE(std::ranges::includes(times_ns[0], times_ns[1]));
}

TEST_F(Interrupted, WithoutAnyResultIs1AndTheOldOutputStays) {
  write_text(out("camera.tum"), "old\n");
  fs::rename(recording_ / "map.yaml", folder_ / "map.yaml");
  std::string other = read_text(folder_ / "map.yaml");
  for (std::size_t at = 0; (at = other.find("  - id: ", at)) != std::string::npos; at += 8)
    other.insert(at + 8, 1, '5');  // the map of another place
  write_text(folder_ / "other.yaml", other);
  const ProgramRun run =
      interrupt({"track", recording_, "--map", folder_ / "other.yaml", "--output", out("camera.tum")});
  EXPECT_THAT(run, EndsWith(1, "warning: interrupted"));
  EXPECT_THAT(run, EndsWith(1, "no tag of the map"));
  EXPECT_EQ(names_in(folder_ / "out"), (std::set<std::string>{"camera.tum"}));
  EXPECT_EQ(read_text(out("camera.tum")), "old\n");
}

TEST_F(Interrupted, ASecondTimeEndsTheProgramAndTheOldOutputStays) {
  write_text(out("camera.tum"), "old\n");
  StartedProgram program({"track", recording_, "--output", out("camera.tum"), "--threads", "1"});
  int pipe = -1;
  ASSERT_TRUE(wait_until(program, [&] { return (pipe = open_pipe()) >= 0; }));
  wait_until(program, [&] {
    program.press_ctrl_c();
    return false;
  });
  ::close(pipe);
  EXPECT_EQ(program.finish().status, 128 + SIGINT);
  EXPECT_EQ(names_in(folder_ / "out"), (std::set<std::string>{"camera.tum"}));
  EXPECT_EQ(read_text(out("camera.tum")), "old\n");
}

TEST(InterruptedSimulation, IsARecordingOfTheFramesUntilThen) {
  const fs::path recording = temporary_folder() / "single";
  constexpr int kMoreThanItGetsTo = 100'000;
  StartedProgram program({"simulate", "--scene", "single", "--frames", std::to_string(kMoreThanItGetsTo),
                          "--threads", "2", "--output", recording, "--json"});
  std::error_code ignored;
  const auto has_frame = [&] {
    return fs::exists(recording / "frames", ignored) && !fs::is_empty(recording / "frames", ignored);
  };
  ASSERT_TRUE(wait_until(program, has_frame));
  program.press_ctrl_c();
  const ProgramRun run = program.finish();
  EXPECT_THAT(run, EndsWith(0, "warning: interrupted"));
  const std::vector<fs::path> images = images_of(recording);
  EXPECT_EQ(json::parse(run.out)["frames"], images.size());
  const Trajectory truth = read_tum(recording / "truth.tum");
  ASSERT_EQ(truth.size(), images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    EXPECT_EQ(images[i].filename().string(), sequence_frame_name(truth[i].timestamp));
    EXPECT_FALSE(read_image(images[i]).view().is_empty());  // throws on one cut short
  }
}

}  // namespace
}  // namespace apriltrack::test
