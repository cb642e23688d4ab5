#include <gmock/gmock.h>

#include <cmath>

#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

TEST(SequenceFolder, WithAFileThatCannotBeLookedAtIsAnIoError) {
  const auto folder = temporary_folder();
  write_frames(folder / "frames", {"1.pgm"});
  for (const char* name : {"frames.csv", "camera.yaml", "map.yaml"}) fs::create_symlink(name, folder / name);
  expect_refused(folder, ErrorKind::kIo, {"frames.csv", "symbolic links"});
  expect_error(ErrorKind::kIo, {"camera.yaml", "symbolic links"},
               [&] { sequence_camera_file(folder.string()); });
  expect_error(ErrorKind::kIo, {"map.yaml", "symbolic links"}, [&] { sequence_map_file(folder.string()); });
}

TEST(Sampling, LeavesOutAndStopsAsAsked) {
  const auto folder = temporary_folder();
  write_frames(folder, {"0000000.pgm", "1000000.pgm", "2000000.pgm", "3000000.pgm", "4000000.pgm",
                        "5000000.pgm", "6000000.pgm"});
  const auto times = [&](const SourceOptions& options) {
    const auto frames = read_all(folder.string(), options);
    EXPECT_EQ(open_source(folder.string(), options)->num_frames(), frames.size());
    return times_of(frames);
  };
  EXPECT_THAT(times({.skip = 2}), ElementsAre(2000000, 3000000, 4000000, 5000000, 6000000));
  EXPECT_THAT(times({.step = 3}), ElementsAre(0, 3000000, 6000000));
  EXPECT_THAT(times({.skip = 1, .step = 2, .max_frames = 2}), ElementsAre(1000000, 3000000));
  EXPECT_THAT(times({.step = 4}), ElementsAre(0, 4000000));
  EXPECT_THAT(times({.skip = 9}), ElementsAre());
  EXPECT_THAT(times({.max_frames = 0}), ElementsAre());
}

TEST(Sampling, RefusesSenselessOptions) {
  const auto folder = temporary_folder();
  write_frames(folder, {"0.pgm"});
  expect_refused(folder, ErrorKind::kInvalidInput, {"--rate", "[0.001, 1e+06]", "-5"}, {.rate_hz = -5.0});
  expect_refused(folder, ErrorKind::kInvalidInput, {"--rate", "nan"}, {.rate_hz = std::nan("")});
  expect_refused(folder, ErrorKind::kInvalidInput, {"--rate", "0.001", "10000000000"}, {.rate_hz = 1e10});
  expect_refused(folder, ErrorKind::kInvalidInput, {"--rate", "0.001", "1e-300"}, {.rate_hz = 1e-300});
  expect_refused(folder, ErrorKind::kInvalidInput, {"--rate", "inf"}, {.rate_hz = HUGE_VAL});
  expect_refused(folder, ErrorKind::kInvalidInput, {"--step", "at least 1"}, {.step = 0});
}

TEST(Glob, TakesWhatMatches) {
  const auto folder = temporary_folder();
  write_frames(folder, {"9000000.pgm", "10000000.pgm", "11000000.pgm", "200000000.pgm"});
  write_text(folder / "1.txt", "x");
  EXPECT_THAT(times_of(read_all((folder / "1*").string())), ElementsAre(10000000, 11000000));
  EXPECT_THAT(times_of(read_all((folder / "[29]*.pgm").string())), ElementsAre(9000000, 200000000));
  EXPECT_THAT(times_of(read_all((folder / "???????.pgm").string())), ElementsAre(9000000));
  expect_refused(folder / "x*.pgm", ErrorKind::kIo, {"x*.pgm", "no file matches"});
  expect_refused(folder / "*.txt", ErrorKind::kIo, {"matches 1 files", "no images"});
}

TEST(Glob, PrefersAFolderOfThatVeryName) {
  const auto folder = temporary_folder() / "take[1]";
  write_frames(folder, {"7.pgm"});
  EXPECT_THAT(times_of(read_all(folder.string())), ElementsAre(7));
}

TEST(SingleImage, NeedsNoRate) {
  const auto folder = temporary_folder();
  write_frames(folder, {"photo.pgm", "123.pgm"});
  EXPECT_THAT(times_of(read_all((folder / "photo.pgm").string())), ElementsAre(0));
  EXPECT_THAT(times_of(read_all((folder / "123.pgm").string())), ElementsAre(123));
}

class Sequence : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temporary_folder();
    write_frames(folder_ / "frames", {"100000000.pgm", "90000000.pgm", "110000000.pgm"});
  }
  void write_csv(const std::string& text) const { write_text(folder_ / "frames.csv", text); }

  fs::path folder_;
};

TEST_F(Sequence, BringsExposureAndGainOfEachFrame) {
  write_csv(
      "timestamp_ns,exposure_s,gain\n90000000,0.004,1\n95000000,0.5,7\n100000000,0.016,2.5\n110000000,,\n");
  const auto frames = read_all(folder_.string());
  EXPECT_THAT(times_of(frames), ElementsAre(90000000, 100000000, 110000000));
  EXPECT_EQ(frames[0].exposure_s, 0.004);
  EXPECT_EQ(frames[1].exposure_s, 0.016);
  EXPECT_EQ(frames[1].gain, 2.5);
  EXPECT_FALSE(frames[2].exposure_s);
  EXPECT_EQ(frames[2].gain, 1.0);
  const Frame view = frames[1].frame(1);
  EXPECT_EQ(view.image.data(), frames[1].pixels.row(0));
  EXPECT_EQ(view.timestamp.ns, 100000000);
  EXPECT_EQ(view.exposure_s, 0.016);
  EXPECT_EQ(view.gain, 2.5);
  EXPECT_EQ(view.camera_index, 1);
}

TEST_F(Sequence, RefusesAWrongFramesCsv) {
  const auto expect_wrong = [&](const std::string& rows, const std::vector<std::string>& words) {
    write_csv("timestamp_ns,exposure_s,gain\n" + rows);
    expect_refused(folder_, ErrorKind::kInvalidInput, words);
  };
  expect_wrong("90,0.01,1\n90,0.01,1\n", {"frames.csv:3", "timestamp_ns", "later", "90"});
  expect_wrong("100,0.01,1\n90,0.01,1\n", {"frames.csv:3", "100", "90"});
  expect_wrong("90,-0.01,1\n", {"frames.csv:2: exposure_s: must lie in [1e-07, 1] seconds (is -0.01)"});
  expect_wrong("90,0.01,0\n", {"frames.csv:2", "gain", "> 0"});
  expect_wrong("90,nan,1\n", {"frames.csv:2", "exposure_s", "nan"});
  expect_wrong("soon,0.01,1\n", {"frames.csv:2", "timestamp_ns", "soon"});
  write_csv("time,exposure_s\n1,2\n");
  expect_refused(folder_, ErrorKind::kInvalidInput, {"frames.csv", "timestamp_ns"});
}

TEST_F(Sequence, RefusesExposuresThatNoCameraHas) {
  for (const char* exposure : {"1e-09", "0", "1.01", "16"}) {
    write_csv(std::string("timestamp_ns,exposure_s\n90000000,0.01\n100000000,") + exposure + "\n");
    expect_refused(folder_, ErrorKind::kInvalidInput,
                   {"frames.csv:3: exposure_s: must lie in [1e-07, 1] seconds", exposure});
  }
  write_csv("timestamp_ns,exposure_s\n90000000,1e-7\n100000000,1\n110000000,5e-7\n");
  EXPECT_EQ(read_all(folder_.string()).back().exposure_s, 5e-7);
}

TEST_F(Sequence, TellsWhereAnExposureStands) {
  write_csv("timestamp_ns,exposure_s,gain\n\n90000000,0.004,1\n100000000,,2\n110000000,0.002,1\n");
  const auto frames = read_all(folder_.string());
  EXPECT_EQ(frames[0].exposure_where, (folder_ / "frames.csv").string() + ":3: exposure_s");
  EXPECT_EQ(frames[1].exposure_where, "");
  EXPECT_EQ(frames[2].exposure_where, (folder_ / "frames.csv").string() + ":5: exposure_s");
}

TEST_F(Sequence, RefusesAFramesCsvOfOtherTimes) {
  write_csv("timestamp_ns,exposure_s\n90,0.01\n100,0.01\n110,0.01\n");  // microseconds
  expect_refused(folder_, ErrorKind::kInvalidInput,
                 {"frames.csv: none of its rows", "from 90 to 110", "from 90000000 to 110000000"});
  write_csv("timestamp_ns,exposure_s\n");
  EXPECT_FALSE(read_all(folder_.string())[0].exposure_s) << "tells nothing, and nothing wrong";
}

TEST_F(Sequence, WarnsOfFramesThatItsFramesCsvDoesNotKnow) {
  std::vector<std::string> told;
  const SourceOptions options{.log = [&](LogLevel, std::string_view text) { told.emplace_back(text); }};
  write_csv("timestamp_ns,exposure_s\n80000000,0.01\n90000000,0.01\n100000000,0.01\n110000000,0.01\n");
  read_all(folder_.string(), options);
  EXPECT_THAT(told, ElementsAre()) << "a row without a frame is of one that was dropped";
  write_csv("timestamp_ns,exposure_s\n80000000,0.01\n90000000,0.02\n");
  EXPECT_EQ(read_all(folder_.string(), options)[0].exposure_s, 0.02);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told[0], ::testing::HasSubstr("frames.csv: 2 of 3 frames have no row in it"));
  EXPECT_THAT(told[0],
              ::testing::HasSubstr("from 80000000 to 90000000, the frames from 90000000 to 110000000"));
}

TEST_F(Sequence, NamesItsCameraAndMapFiles) {
  EXPECT_FALSE(sequence_camera_file(folder_.string()));
  EXPECT_FALSE(sequence_map_file(folder_.string()));
  write_text(folder_ / "camera.yaml", "cam0: {}");
  write_text(folder_ / "map.yaml", "tags: []");
  EXPECT_EQ(sequence_camera_file(folder_.string()), folder_ / "camera.yaml");
  EXPECT_EQ(sequence_map_file(folder_.string()), folder_ / "map.yaml");
  write_text(folder_ / "other" / "camera.yaml", "cam0: {}");
  EXPECT_FALSE(sequence_camera_file((folder_ / "other").string()));
  EXPECT_FALSE(sequence_camera_file("camera:0"));
}

TEST(LiveCamera, ThatCannotBeOpenedIsNamed) {
  expect_refused("camera:", ErrorKind::kInvalidInput, {"camera:0"});
  expect_refused("camera:front", ErrorKind::kInvalidInput, {"'front'", "camera:0"});
  expect_refused("camera:-1", ErrorKind::kInvalidInput, {"'-1'"});
  expect_refused("camera:255", ErrorKind::kIo, {"camera:255", "plugged in"});
  expect_refused("/dev/video254", ErrorKind::kIo, {"/dev/video254", "no such camera"});
}

TEST(OtherFiles, AreRefusedWithTheirName) {
  const auto folder = temporary_folder();
  write_text(folder / "empty.mp4", "");
  write_text(folder / "notes.txt", "a text\nof two lines");
  write_text(folder / "noise.mp4", std::string("\x01\x02\x00\x03 noise", 10));
  expect_refused(folder / "empty.mp4", ErrorKind::kIo, {"empty.mp4", "0 bytes"});
  expect_refused(folder / "notes.txt", ErrorKind::kIo, {"notes.txt", "text file"});
  expect_refused(folder / "noise.mp4", ErrorKind::kIo, {"noise.mp4", "neither an image nor a video"});
  expect_refused("", ErrorKind::kInvalidInput, {"INPUT", "empty"});
}

TEST(SharedRecording, IsReadWholeAndInOrder) {
  APRILTRACK_SHARED_OR_SKIP(folder, "data/room_blur");
  const auto source = open_source(folder.string());
  ASSERT_EQ(source->num_frames(), 360U);
  std::int64_t last_ns = -1;
  int num_frames = 0;
  for (; const auto frame = source->next(); ++num_frames) {
    ASSERT_TRUE(frame->is_readable()) << frame->error;
    ASSERT_GT(frame->timestamp.ns, last_ns);
    last_ns = frame->timestamp.ns;
  }
  EXPECT_EQ(num_frames, 360);
  EXPECT_EQ(last_ns, 12016604000);
  EXPECT_TRUE(sequence_camera_file(folder.string()));
}

}  // namespace
}  // namespace apriltrack::test
