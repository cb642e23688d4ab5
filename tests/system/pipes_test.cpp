// `track -` and `--output -`: pictures in by a pipe, poses out by another, each as soon as it is known.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "apriltrack/eval/trajectory.h"
#include "apriltrack/source/image_file.h"
#include "program.h"
#include "support/shared_data.h"
#include "video_files.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

/// A run with pipes at stdin and stdout; stderr goes to a file.
class PipedProgram {
 public:
  PipedProgram(const std::vector<std::string>& words, const fs::path& err) {
    int in[2], out[2];
    if (::pipe(in) != 0 || ::pipe(out) != 0) std::abort();
    std::signal(SIGPIPE, SIG_IGN);
    child_ = ::fork();
    if (child_ == 0) {
      ::dup2(in[0], STDIN_FILENO);
      ::dup2(out[1], STDOUT_FILENO);
      for (const int end : {in[0], in[1], out[0], out[1]}) ::close(end);
      if (!std::freopen(err.c_str(), "w", stderr)) ::_exit(127);
      std::vector<char*> arguments{const_cast<char*>(APRILTRACK_PROGRAM)};
      for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      ::execv(APRILTRACK_PROGRAM, arguments.data());
      ::_exit(127);
    }
    ::close(in[0]);
    ::close(out[1]);
    to_ = in[1];
    from_ = out[0];
  }
  ~PipedProgram() {
    end_input();
    if (from_ >= 0) ::close(from_);
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
  }
  PipedProgram(const PipedProgram&) = delete;
  PipedProgram& operator=(const PipedProgram&) = delete;

  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::write(to_, bytes.data(), bytes.size());
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  void end_input() {
    if (to_ >= 0) ::close(to_);
    to_ = -1;
  }
  /// Nobody reads its stdout any more.
  void stop_reading() {
    ::close(from_);
    from_ = -1;
  }
  /// What comes until a line is there, or nothing came for a minute, or all has come.
  std::string read_line() {
    for (;;) {
      const std::size_t end = pending_.find('\n');
      if (end != std::string::npos) {
        const std::string line = pending_.substr(0, end + 1);
        pending_.erase(0, end + 1);
        return line;
      }
      pollfd ready{from_, POLLIN, 0};
      char buffer[4096];
      if (::poll(&ready, 1, 60'000) <= 0) return "";
      const ssize_t count = ::read(from_, buffer, sizeof buffer);
      if (count <= 0) return "";
      pending_.append(buffer, static_cast<std::size_t>(count));
    }
  }
  int status() {
    int wait_status = 0;
    ::waitpid(child_, &wait_status, 0);
    child_ = -1;
    return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : -1;
  }

 private:
  pid_t child_ = -1;
  int to_ = -1, from_ = -1;
  std::string pending_;
};

class Pipes : public ::testing::Test {
 protected:
  static constexpr int kFrames = 30;

  /// Made by the test that comes first.
  void SetUp() override {
    if (!files_) make_files();
  }
  static void make_files() {
    files_ = new Files;
    run_for_json({"simulate", "--scene", "room-gentle", "--frames", std::to_string(kFrames), "--exposure",
                  "0.002", "--output", files_->film});
    VideoPlan plan;
    std::vector<fs::path> frames;
    for (const auto& entry : fs::directory_iterator(files_->film + "/frames")) frames.push_back(entry.path());
    std::ranges::sort(frames);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      plan.pictures.push_back(read_image(frames[i]));
      plan.times_ticks.push_back(static_cast<std::int64_t>(i) * kTicksPerSecond / 20);
      write_image(files_->folder / "picture.jpg", plan.pictures.back().view());
      files_->jpegs.push_back(read_text(files_->folder / "picture.jpg"));
    }
    write_mjpeg_video(files_->mkv, plan);
    write_mjpeg_video(files_->mp4, plan);
    write_b_frame_video(files_->ts, plan);
  }
  static void TearDownTestSuite() {
    delete files_;
    files_ = nullptr;
  }

  struct Files {
    const fs::path folder = temporary_folder();
    const std::string film = folder / "film", mkv = folder / "film.mkv", mp4 = folder / "film.mp4",
                      ts = folder / "film.ts";
    std::vector<std::string> jpegs;
  };
  static inline Files* files_ = nullptr;

  static std::vector<std::string> track(const std::string& input, const std::string& output) {
    return {"track",    input,
            "--camera", files_->film + "/camera.yaml",
            "--map",    files_->film + "/map.yaml",
            "--seed",   "5",
            "--output", output};
  }
  static std::string err_file() { return files_->folder / "err"; }

  /// What a run says on stdout of a file sent to it.
  static std::string poses_of(const std::string& file, const std::vector<std::string>& words,
                              int expected_status) {
    PipedProgram program(words, err_file());
    program.send(read_text(file));
    program.end_input();
    std::string all;
    for (std::string line; !(line = program.read_line()).empty();) all += line;
    EXPECT_EQ(program.status(), expected_status) << read_text(err_file());
    return all;
  }
};

TEST_F(Pipes, PosesOfAPipedVideoAreThoseOfItsFile) {
  for (const std::string& file : {files_->mkv, files_->ts}) {
    const std::string out = files_->folder / "out.tum";
    const auto run = run_program(track(file, out));
    ASSERT_EQ(run.status, 0) << run.err;
    const std::string poses = poses_of(file, track("-", "-"), 0);
    EXPECT_EQ(poses, read_text(out));
    EXPECT_GT(std::ranges::count(poses, '\n'), kFrames / 2);
  }
  EXPECT_NE(read_text(err_file()).find("with a pose"), std::string::npos);
}

// All its tags tell the response, and a pipe cannot be read again by it.
TEST_F(Pipes, TagsOfAPipeAreKeptWhereNothingStatesTheResponse) {
  const std::string camera = files_->folder / "unstated.yaml", table = files_->folder / "tags.csv";
  std::string text = read_text(files_->film + "/camera.yaml");
  const std::size_t at = text.find("  response:");
  ASSERT_NE(at, std::string::npos) << text;
  text.replace(at, text.find('\n', at) - at, "  # nothing of its response");
  write_text(camera, text);
  poses_of(files_->ts, {"detect", "-", "--camera", camera, "--output", table}, 0);
  EXPECT_EQ(run_for_json({"detect", files_->ts, "--camera", camera, "--output",
                          files_->folder / "of_file.csv"})["response"]["origin"],
            "estimated");
  const auto lines = [](const std::string& file) { return std::ranges::count(read_text(file), '\n'); };
  EXPECT_NEAR(static_cast<double>(lines(table)), static_cast<double>(lines(files_->folder / "of_file.csv")),
              3.0)
      << "by another response hardly other tags are found";
  EXPECT_THAT(read_text(err_file()),
              ::testing::HasSubstr("was taken for its response, which nothing states"));
}

TEST_F(Pipes, EachPoseIsToldBeforeThePicturesEnd) {
  std::vector<std::string> words = track("-", "-");
  words.insert(words.end(), {"--rate", "20"});
  PipedProgram program(words, err_file());
  for (std::size_t i = 0; i < 20; ++i) ASSERT_TRUE(program.send(files_->jpegs[i]));
  std::size_t num_told = 0;
  std::string last;
  // Of twenty pictures, the decoder may keep the last few back until it knows that they end.
  for (std::string line; num_told < 12 && !(line = program.read_line()).empty(); ++num_told) last = line;
  EXPECT_EQ(num_told, 12u) << read_text(err_file());
  write_text(files_->folder / "last.tum", last);
  EXPECT_EQ(read_tum(files_->folder / "last.tum").size(), 1u);
  for (std::size_t i = 20; i < files_->jpegs.size(); ++i) ASSERT_TRUE(program.send(files_->jpegs[i]));
  program.end_input();
  while (!program.read_line().empty()) ++num_told;
  EXPECT_EQ(program.status(), 0) << read_text(err_file());
  EXPECT_GT(num_told, 20u);
}

TEST_F(Pipes, PicturesOneAfterTheOtherNeedARate) {
  PipedProgram program(track("-", "-"), err_file());
  for (const std::string& jpeg : files_->jpegs) program.send(jpeg);
  program.end_input();
  EXPECT_EQ(program.read_line(), "");
  EXPECT_EQ(program.status(), 2);
  EXPECT_NE(read_text(err_file()).find("--rate"), std::string::npos) << read_text(err_file());
}

TEST_F(Pipes, WhatCannotBePipedTeachesWhatCan) {
  for (const std::string& file : {files_->mp4, files_->film + "/camera.yaml"}) {
    EXPECT_EQ(poses_of(file, track("-", "-"), 3), "") << file;
    EXPECT_NE(read_text(err_file()).find("-f matroska -"), std::string::npos) << read_text(err_file());
  }
  const auto nothing = run_program(track("-", files_->folder / "o.tum"));  // stdin is /dev/null
  EXPECT_EQ(nothing.status, 3) << nothing.err;
  for (const std::string command : {"doctor", "calibrate"}) {
    std::vector<std::string> words = {command, "-", "--camera", files_->film + "/camera.yaml"};
    if (command == "calibrate") words.insert(words.end(), {"--tag-size", "0.1", "--output", "m.yaml"});
    EXPECT_THAT(run_program(words), EndsWith(2, "is a pipe"));
  }
}

TEST_F(Pipes, AFileThatIsStdinMayBeAnyVideo) {
  const std::string out = files_->folder / "mp4.tum";
  const std::string command =
      fmt::format("'{}' track - --camera '{}/camera.yaml' --map '{}/map.yaml' --output '{}' <'{}' 2>'{}' >&2",
                  APRILTRACK_PROGRAM, files_->film, files_->film, out, files_->mp4, err_file());
  ASSERT_EQ(std::system(command.c_str()), 0) << read_text(err_file());
  EXPECT_GT(read_tum(out).size(), 15u);
}

TEST_F(Pipes, StdoutHasRoomForPosesAlone) {
  std::vector<std::string> words = track(files_->film, "-");
  words.push_back("--json");
  EXPECT_THAT(run_program(words), EndsWith(2, "--json"));
  words.back() = "--output-format";
  words.push_back("kitti");
  EXPECT_THAT(run_program(words), EndsWith(2, "--output-format"));
}

TEST_F(Pipes, AReaderThatGoesAwayEndsTheRunUnlessFilesAreWritten) {
  for (const bool has_log : {false, true}) {
    const std::string log = files_->folder / "frames.csv";
    fs::remove(log);
    std::vector<std::string> words = track(files_->film, "-");
    if (has_log) words.insert(words.end(), {"--frames-csv", log});
    PipedProgram program(words, err_file());
    program.stop_reading();
    EXPECT_EQ(program.status(), 3) << read_text(err_file());
    EXPECT_NE(read_text(err_file()).find("--output -"), std::string::npos) << read_text(err_file());
    EXPECT_EQ(fs::exists(log), has_log);
  }
}

}  // namespace
}  // namespace apriltrack::test
