#include <gmock/gmock.h>

#include <cmath>

#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

void write_frames(const fs::path& folder, const std::vector<std::string>& names) {
  int seed = 0;
  for (const std::string& name : names) {
    fs::create_directories(folder);
    write_pgm(folder / name, test_picture(8, 6, seed++));
  }
}

TEST(ImageFolder, TakesTimesFromNamesInTheOrderOfNumbers) {
  const auto folder = temporary_folder();
  write_frames(folder, {"10000.pgm", "9000.pgm", "1000000000000000001.pgm"});
  write_text(folder / "notes.txt", "not a frame");
  write_frames(folder, {".hidden.pgm"});
  const auto frames = read_all(folder.string());
  EXPECT_THAT(times_of(frames), ElementsAre(9000, 10000, 1000000000000000001));
  EXPECT_THAT(frames[0].pixels, SamePixels(test_picture(8, 6, 1)));
  EXPECT_THAT(frames[1].pixels, SamePixels(test_picture(8, 6, 0)));
  EXPECT_EQ(frames[0].name, (folder / "9000.pgm").string());
  EXPECT_EQ(frames[0].gain, 1.0);
  EXPECT_FALSE(frames[0].exposure_s);
}

TEST(ImageFolder, GivesOtherNamesTheirTimeByTheRate) {
  const auto folder = temporary_folder();
  write_frames(folder, {"image9.pgm", "image10.pgm", "image1.pgm", "image2.PGM"});
  const auto frames = read_all(folder.string(), {.rate_hz = 30.0});
  EXPECT_THAT(times_of(frames), ElementsAre(0, 33333333, 66666667, 100000000));
  EXPECT_THAT(frames[3].name, HasSubstr("image10.pgm"));
}

TEST(ImageFolder, NeedsARateWhereNamesAreNoTimes) {
  const auto folder = temporary_folder();
  write_frames(folder, {"a.pgm", "b.pgm"});
  expect_refused(folder, ErrorKind::kInvalidInput, {folder.string(), "'a.pgm'", "--rate HZ"});
}

TEST(ImageFolder, KeepsTimesInNamesWhateverTheRate) {
  const auto folder = temporary_folder();
  write_frames(folder, {"100000000.pgm", "140000000.pgm"});
  EXPECT_THAT(times_of(read_all(folder.string(), {.rate_hz = 30.0})), ElementsAre(100000000, 140000000));
}

TEST(ImageFolder, TakesCountedNamesForFrameNumbersWhenARateIsGiven) {
  const auto folder = temporary_folder();
  write_frames(folder, {"0001.pgm", "0002.pgm", "0010.pgm"});
  EXPECT_THAT(times_of(read_all(folder.string(), {.rate_hz = 10.0})),
              ElementsAre(100000000, 200000000, 1000000000));
  const auto gap = temporary_folder() / "gap";
  write_frames(gap, {"1.pgm", "2.pgm", "3.pgm", "4.pgm", "5.pgm", "6.pgm", "100000.pgm"});
  EXPECT_THAT(times_of(read_all(gap.string(), {.rate_hz = 15.0})),
              ElementsAre(66666667, 133333333, 200000000, 266666667, 333333333, 400000000, 6666666666667));
  const auto apart = temporary_folder() / "apart";
  write_frames(apart, {"0.pgm", "999.pgm", "1998.pgm"});
  EXPECT_THAT(times_of(read_all(apart.string(), {.rate_hz = 10.0})),
              ElementsAre(0, 99900000000, 199800000000));
}

TEST(ImageFolder, RefusesNumbersThatAreNeitherTimesNorFramesOfTheRate) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"1000000.pgm", "1033333.pgm", "1066666.pgm"}, "33.33 us"},        // microseconds
      {{"1000.pgm", "2000.pgm", "3000.pgm"}, "1 us"},                     // every thousandth frame
      {{"1000000000.pgm", "1200000000.pgm", "1400000000.pgm"}, "200 ms"}  // nanoseconds at 5 Hz
  };
  const auto folder = temporary_folder();
  for (const auto& [names, step] : cases) {
    const auto frames = folder / names[1];
    write_frames(frames, names);
    expect_refused(
        frames, ErrorKind::kInvalidInput,
        {frames.string(), step + " apart", "--rate 30 says 33.33 ms", "nanoseconds", "frame numbers"},
        {.rate_hz = 30.0});
    EXPECT_EQ(read_all(frames.string()).size(), 3u) << "without a rate they are nanoseconds";
  }
  const auto endless = folder / "endless";
  write_frames(endless, {"9000000000000000000.pgm", "9000000000000000001.pgm"});
  expect_refused(endless, ErrorKind::kInvalidInput, {"9000000000000000000", "64 bits"}, {.rate_hz = 30.0});
}

TEST(ImageFolder, KeepsTimesWithinThreeTimesTheRatesPeriod) {
  const auto folder = temporary_folder();
  write_frames(folder, {"1000000000.pgm", "1033000000.pgm", "1066000000.pgm", "1900000000.pgm"});
  for (const double rate_hz : {10.2, 30.0, 90.0}) {
    EXPECT_THAT(times_of(read_all(folder.string(), {.rate_hz = rate_hz})),
                ElementsAre(1000000000, 1033000000, 1066000000, 1900000000));
  }
  for (const double rate_hz : {10.0, 91.0})
    expect_refused(folder, ErrorKind::kInvalidInput, {"33 ms apart"}, {.rate_hz = rate_hz});
}

TEST(ImageFolder, RefusesFrameNumbersWithoutARate) {
  const auto folder = temporary_folder();
  write_frames(folder, {"0001.pgm", "0002.pgm"});
  expect_refused(folder, ErrorKind::kInvalidInput, {"0002.pgm: is 1 ns after 0001.pgm", "--rate HZ"});
  const auto apart = temporary_folder() / "apart";  // on the average, and yet no times
  write_frames(apart, {"1.pgm", "2.pgm", "9000.pgm"});
  expect_refused(apart, ErrorKind::kInvalidInput, {"2.pgm: is 1 ns after 1.pgm", "--rate HZ"});
  EXPECT_THAT(times_of(read_all(apart.string(), {.rate_hz = 10.0})),
              ElementsAre(100000000, 200000000, 900000000000));
}

TEST(ImageFolder, TakesNamesAMicrosecondApartForTimes) {
  const auto folder = temporary_folder();
  write_frames(folder, {"1.pgm", "1001.pgm"});
  EXPECT_THAT(times_of(read_all(folder.string())), ElementsAre(1, 1001));
}

TEST(ImageFolder, RefusesHalfTimedRepeatedAndOverlongNames) {
  const auto mixed = temporary_folder() / "mixed";
  write_frames(mixed, {"1.pgm", "2.pgm", "last.pgm"});
  expect_refused(mixed, ErrorKind::kInvalidInput, {"2 of 3", "'last.pgm'"}, {.rate_hz = 10.0});
  const auto repeated = temporary_folder() / "repeated";
  write_frames(repeated, {"5.pgm", "05.pgm"});
  expect_refused(repeated, ErrorKind::kInvalidInput, {"same time", "5 ns"});
  expect_refused(repeated, ErrorKind::kInvalidInput, {"same time", "5 ns"}, {.rate_hz = 10.0});
  const auto overlong = temporary_folder() / "overlong";
  write_frames(overlong, {"99999999999999999999.pgm"});
  expect_refused(overlong, ErrorKind::kInvalidInput, {"99999999999999999999.pgm", "64 bits"});
}

TEST(ImageFolder, HandsOutDamagedImagesAsUnreadableFrames) {
  const auto folder = temporary_folder();
  write_frames(folder, {"1000.pgm", "4000.pgm"});
  write_text(folder / "2000.jpg", "");
  write_text(folder / "3000.png", "words");
  const auto frames = read_all(folder.string());
  EXPECT_THAT(times_of(frames), ElementsAre(1000, 2000, 3000, 4000));
  EXPECT_TRUE(frames[0].is_readable());
  EXPECT_EQ(frames[1].error, "the file is empty (0 bytes)");
  EXPECT_THAT(frames[2].error, StartsWith("is not an image"));
  EXPECT_TRUE(frames[1].pixels.is_empty());
  EXPECT_TRUE(frames[3].is_readable());
}

TEST(ImageFolder, HandsOutMixedSizesAsTheyAre) {
  const auto folder = temporary_folder();
  write_pgm(folder / "1000.pgm", test_picture(8, 6));
  write_pgm(folder / "2000.pgm", test_picture(5, 9));
  const auto frames = read_all(folder.string());
  EXPECT_EQ(frames[0].pixels.width(), 8);
  EXPECT_EQ(frames[1].pixels.width(), 5);
}

TEST(ImageFolder, ReadsEachImageOnlyWhenItIsAskedFor) {
  const auto folder = temporary_folder();
  write_frames(folder, {"1000.pgm", "2000.pgm"});
  const auto source = open_source(folder.string());
  EXPECT_EQ(source->num_frames(), 2U);
  EXPECT_TRUE(source->next()->is_readable());
  write_pgm(folder / "2000.pgm",
            test_picture(3, 3));  // after opening: a source that read ahead would not see it
  EXPECT_EQ(source->next()->pixels.width(), 3);
  EXPECT_FALSE(source->next());
}

TEST(ImageFolder, WithoutImagesIsAnError) {
  const auto folder = temporary_folder();
  expect_refused(folder, ErrorKind::kIo, {folder.string(), "holds no images", ".png"});
  expect_refused(folder / "missing", ErrorKind::kIo, {"missing", "no such file or folder"});
  write_text(folder / "frames" / "readme.txt", "x");
  expect_refused(folder, ErrorKind::kIo, {"frames", "holds no images"});
}

TEST(ImageFolder, KeepsFramesApartAtTheEndsOfTheRateRange) {
  const auto folder = temporary_folder();
  write_frames(folder, {"a.pgm", "b.pgm", "c.pgm"});
  EXPECT_THAT(times_of(read_all(folder.string(), {.rate_hz = 1e6})), ElementsAre(0, 1000, 2000));
  EXPECT_THAT(times_of(read_all(folder.string(), {.rate_hz = 1e-3})),
              ElementsAre(0, 1'000'000'000'000, 2'000'000'000'000));
}

TEST(ImageFolder, HandsOutALoopOfLinksAsAnUnreadableFrame) {
  const auto folder = temporary_folder();
  write_frames(folder, {"1000.pgm"});
  fs::create_symlink("2000.pgm", folder / "2000.pgm");
  for (const std::string& input : {folder.string(), (folder / "*.pgm").string()}) {
    const auto frames = read_all(input);
    ASSERT_THAT(times_of(frames), ElementsAre(1000, 2000)) << input;
    EXPECT_TRUE(frames[0].is_readable());
    EXPECT_THAT(frames[1].error, HasSubstr("symbolic links"));
    EXPECT_THAT(frames[1].error, Not(HasSubstr("2000.pgm")));  // which is the frame's name
  }
}

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
  write_frames(folder, {"0000.pgm", "1000.pgm", "2000.pgm", "3000.pgm", "4000.pgm", "5000.pgm", "6000.pgm"});
  const auto times = [&](const SourceOptions& options) {
    const auto frames = read_all(folder.string(), options);
    EXPECT_EQ(open_source(folder.string(), options)->num_frames(), frames.size());
    return times_of(frames);
  };
  EXPECT_THAT(times({.skip = 2}), ElementsAre(2000, 3000, 4000, 5000, 6000));
  EXPECT_THAT(times({.step = 3}), ElementsAre(0, 3000, 6000));
  EXPECT_THAT(times({.skip = 1, .step = 2, .max_frames = 2}), ElementsAre(1000, 3000));
  EXPECT_THAT(times({.step = 4}), ElementsAre(0, 4000));
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
  write_frames(folder, {"9000.pgm", "10000.pgm", "11000.pgm", "200000.pgm"});
  write_text(folder / "1.txt", "x");
  EXPECT_THAT(times_of(read_all((folder / "1*").string())), ElementsAre(10000, 11000));
  EXPECT_THAT(times_of(read_all((folder / "[29]*.pgm").string())), ElementsAre(9000, 200000));
  EXPECT_THAT(times_of(read_all((folder / "????.pgm").string())), ElementsAre(9000));
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
    write_frames(folder_ / "frames", {"100000.pgm", "90000.pgm", "110000.pgm"});
  }
  void write_csv(const std::string& text) const { write_text(folder_ / "frames.csv", text); }

  fs::path folder_;
};

TEST_F(Sequence, BringsExposureAndGainOfEachFrame) {
  write_csv("timestamp_ns,exposure_s,gain\n90000,0.004,1\n95000,0.5,7\n100000,0.016,2.5\n110000,,\n");
  const auto frames = read_all(folder_.string());
  EXPECT_THAT(times_of(frames), ElementsAre(90000, 100000, 110000));
  EXPECT_EQ(frames[0].exposure_s, 0.004);
  EXPECT_EQ(frames[1].exposure_s, 0.016);
  EXPECT_EQ(frames[1].gain, 2.5);
  EXPECT_FALSE(frames[2].exposure_s);
  EXPECT_EQ(frames[2].gain, 1.0);
  const Frame view = frames[1].frame(1);
  EXPECT_EQ(view.image.data(), frames[1].pixels.row(0));
  EXPECT_EQ(view.timestamp.ns, 100000);
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
  expect_wrong("90,-0.01,1\n", {"frames.csv:2", "exposure_s", "> 0", "-0.01"});
  expect_wrong("90,0.01,0\n", {"frames.csv:2", "gain", "> 0"});
  expect_wrong("90,nan,1\n", {"frames.csv:2", "exposure_s", "nan"});
  expect_wrong("soon,0.01,1\n", {"frames.csv:2", "timestamp_ns", "soon"});
  write_csv("time,exposure_s\n1,2\n");
  expect_refused(folder_, ErrorKind::kInvalidInput, {"frames.csv", "timestamp_ns"});
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

class Euroc : public ::testing::Test {
 protected:
  void SetUp() override {
    root_ = temporary_folder();
    camera_ = root_ / "mav0" / "cam0";
    write_frames(camera_ / "data", {"1403636579763555584.pgm", "1403636579813555456.pgm"});
    write_csv(
        "1403636579763555584,1403636579763555584.pgm\r\n1403636579813555456,1403636579813555456.pgm\r\n");
  }
  void write_csv(const std::string& rows) const {
    write_text(camera_ / "data.csv", "#timestamp [ns],filename\r\n" + rows);
  }

  fs::path root_;
  fs::path camera_;
};

TEST_F(Euroc, IsReadFromItsRootItsMav0AndItsCameraFolder) {
  for (const fs::path& input : {root_, root_ / "mav0", camera_}) {
    const auto frames = read_all(input.string());
    EXPECT_THAT(times_of(frames), ElementsAre(1403636579763555584, 1403636579813555456)) << input;
    EXPECT_THAT(frames[1].pixels, SamePixels(test_picture(8, 6, 1)));
  }
}

TEST_F(Euroc, TakesTheCameraThatIsAskedFor) {
  const fs::path second = root_ / "mav0" / "cam1";
  write_text(second / "data.csv", "#timestamp [ns],filename\n7,7.pgm\n");
  fs::create_directories(second / "data");
  write_pgm(second / "data" / "7.pgm", test_picture(8, 6, 42));
  write_text(root_ / "mav0" / "imu0" / "data.csv", "#timestamp [ns],w_RS_S_x\n");
  for (const fs::path& input : {root_, root_ / "mav0"}) {
    const auto frames = read_all(input.string(), {.camera_name = "cam1"});
    ASSERT_THAT(times_of(frames), ElementsAre(7)) << input;
    EXPECT_THAT(frames[0].pixels, SamePixels(test_picture(8, 6, 42)));
    EXPECT_EQ(read_all(input.string(), {.camera_name = "cam0"}).size(), 2U);
    expect_refused(input, ErrorKind::kInvalidInput, {input.string(), "no camera 'imu1'", "has: cam0, cam1;"},
                   {.camera_name = "imu1"});
  }
  // The folder of one camera is that camera, whatever its file calls it.
  EXPECT_THAT(times_of(read_all(second.string(), {.camera_name = "left"})), ElementsAre(7));
  fs::remove_all(camera_);
  expect_refused(root_, ErrorKind::kInvalidInput, {"no camera 'cam0'", "has: cam1;", "--camera-name"});
}

TEST_F(Euroc, TakesTheTimeFromTheTableAndNotFromTheName) {
  write_csv("5000,1403636579813555456.pgm\n");
  EXPECT_THAT(times_of(read_all(camera_.string())), ElementsAre(5000));
}

TEST_F(Euroc, CountsAListedButMissingImageAsUnreadable) {
  write_csv("1,gone.pgm\n2,1403636579813555456.pgm\n");
  const auto frames = read_all(camera_.string());
  ASSERT_THAT(times_of(frames), ElementsAre(1, 2));
  EXPECT_EQ(frames[0].error, "no such file");
  EXPECT_TRUE(frames[1].is_readable());
}

TEST_F(Euroc, RefusesAWrongTable) {
  write_csv("2,a.pgm\n1,b.pgm\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv:3", "later", "is 1"});
  write_csv("2,a.pgm\n2,b.pgm\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv:3"});
  write_csv("2,\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv:2", "filename"});
  write_csv("");
  expect_refused(camera_, ErrorKind::kIo, {"data.csv", "lists no images"});
  write_text(camera_ / "data.csv", "1,a.pgm\n");
  expect_refused(camera_, ErrorKind::kInvalidInput, {"data.csv", "timestamp [ns]"});
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
