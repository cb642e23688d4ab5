#include <gmock/gmock.h>

#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(ImageFolder, TakesTimesFromNamesInTheOrderOfNumbers) {
  const auto folder = temporary_folder();
  write_frames(folder, {"10000000.pgm", "9000000.pgm", "1000000000000000001.pgm"});
  write_text(folder / "notes.txt", "not a frame");
  write_frames(folder, {".hidden.pgm"});
  const auto frames = read_all(folder.string());
  EXPECT_THAT(times_of(frames), ElementsAre(9000000, 10000000, 1000000000000000001));
  EXPECT_THAT(frames[0].pixels, SamePixels(test_picture(8, 6, 1)));
  EXPECT_THAT(frames[1].pixels, SamePixels(test_picture(8, 6, 0)));
  EXPECT_EQ(frames[0].name, (folder / "9000000.pgm").string());
  EXPECT_EQ(frames[0].gain, 1.0);
  EXPECT_FALSE(frames[0].exposure_s);
}

/// As folders of TUM's RGB-D benchmark are named; without zeros at the end, the order of time is not that of
/// the text.
TEST(ImageFolder, TakesTimesInSecondsWithAPoint) {
  const auto folder = temporary_folder();
  write_frames(folder, {"1305031102.175304.pgm", "1305031102.2113.pgm", "1305031102.243211.pgm"});
  for (const SourceOptions& options : {SourceOptions{}, SourceOptions{.rate_hz = 30.0}}) {
    const auto frames = read_all(folder.string(), options);
    EXPECT_THAT(times_of(frames), ElementsAre(1305031102175304000, 1305031102211300000, 1305031102243211000));
    EXPECT_THAT(frames[1].pixels, SamePixels(test_picture(8, 6, 1)));
  }
  expect_refused(folder, ErrorKind::kInvalidInput, {"read as seconds", "ms apart", "--rate 2 says 500 ms"},
                 {.rate_hz = 2.0});
}

TEST(ImageFolder, RefusesTimesInSecondsThatAreTheSameOrNotOfAll) {
  const auto same = temporary_folder() / "same";
  write_frames(same, {"1.1.pgm", "1.10.pgm"});
  expect_refused(same, ErrorKind::kInvalidInput, {"1.1", "is 0 ns after", "times in seconds"});
  const auto mixed = temporary_folder() / "mixed";
  write_frames(mixed, {"1.1.pgm", "1.2.pgm", "2.pgm"});
  expect_refused(mixed, ErrorKind::kInvalidInput, {"2 of 3", "'2.pgm'", "seconds with a point"});
  expect_refused(mixed, ErrorKind::kInvalidInput, {"2 of 3", "'2.pgm'"}, {.rate_hz = 10.0});
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
      {{"1000000.pgm", "1003333.pgm", "1006666.pgm"}, "3.333 us"},        // 300 Hz in microseconds
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
  }
  const auto endless = folder / "endless";
  write_frames(endless, {"9000000000000000000.pgm", "9000000000000000001.pgm"});
  expect_refused(endless, ErrorKind::kInvalidInput, {"1 ns apart"}, {.rate_hz = 30.0});
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

TEST(ImageFolder, TakesTheUnitOfTimesInNamesFromTheRate) {
  const auto folder = temporary_folder();
  write_frames(folder / "us", {"1700000000000000.pgm", "1700000000033333.pgm", "1700000000066666.pgm"});
  EXPECT_THAT(times_of(read_all((folder / "us").string(), {.rate_hz = 30.0})),
              ElementsAre(1700000000000000000, 1700000000033333000, 1700000000066666000));
  write_frames(folder / "ms", {"1700000000000.pgm", "1700000000033.pgm", "1700000000067.pgm"});
  EXPECT_THAT(times_of(read_all((folder / "ms").string(), {.rate_hz = 30.0})),
              ElementsAre(1700000000000000000, 1700000000033000000, 1700000000067000000));
  write_frames(folder / "s", {"1700000000.pgm", "1700000002.pgm"});
  EXPECT_THAT(times_of(read_all((folder / "s").string(), {.rate_hz = 0.5})),
              ElementsAre(1700000000000000000, 1700000002000000000));
  write_frames(folder / "beyond", {"9300000000000000.pgm", "9300000000033333.pgm"});
  expect_refused(folder / "beyond", ErrorKind::kInvalidInput, {"9300000000000000.pgm", "64 bits"},
                 {.rate_hz = 30.0});
}

TEST(ImageFolder, RefusesRatesThatNoCameraHasWithoutBeingTold) {
  const auto folder = temporary_folder();
  write_frames(folder / "us", {"1700000000000000.pgm", "1700000000033333.pgm", "1700000000066666.pgm"});
  expect_refused(folder / "us", ErrorKind::kInvalidInput, {"33.33 us apart", "3e+04 frames", "--rate HZ"});
  write_frames(folder / "fast", {"1.pgm", "1001.pgm"});
  EXPECT_THAT(times_of(read_all((folder / "fast").string(), {.rate_hz = 1e6})), ElementsAre(1, 1001));
  write_frames(folder / "10_kHz", {"1.pgm", "100001.pgm"});
  EXPECT_THAT(times_of(read_all((folder / "10_kHz").string())), ElementsAre(1, 100001));
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
  write_frames(folder, {"1000000.pgm", "4000000.pgm"});
  write_text(folder / "2000000.jpg", "");
  write_text(folder / "3000000.png", "words");
  const auto frames = read_all(folder.string());
  EXPECT_THAT(times_of(frames), ElementsAre(1000000, 2000000, 3000000, 4000000));
  EXPECT_TRUE(frames[0].is_readable());
  EXPECT_EQ(frames[1].error, "the file is empty (0 bytes)");
  EXPECT_THAT(frames[2].error, StartsWith("is not an image"));
  EXPECT_TRUE(frames[1].pixels.is_empty());
  EXPECT_TRUE(frames[3].is_readable());
}

TEST(ImageFolder, HandsOutMixedSizesAsTheyAre) {
  const auto folder = temporary_folder();
  write_pgm(folder / "1000000.pgm", test_picture(8, 6));
  write_pgm(folder / "2000000.pgm", test_picture(5, 9));
  const auto frames = read_all(folder.string());
  EXPECT_EQ(frames[0].pixels.width(), 8);
  EXPECT_EQ(frames[1].pixels.width(), 5);
}

TEST(ImageFolder, ReadsEachImageOnlyWhenItIsAskedFor) {
  const auto folder = temporary_folder();
  write_frames(folder, {"1000000.pgm", "2000000.pgm"});
  const auto source = open_source(folder.string());
  EXPECT_EQ(source->num_frames(), 2U);
  EXPECT_TRUE(source->next()->is_readable());
  write_pgm(folder / "2000000.pgm",
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
  write_frames(folder, {"1000000.pgm"});
  fs::create_symlink("2000000.pgm", folder / "2000000.pgm");
  for (const std::string& input : {folder.string(), (folder / "*.pgm").string()}) {
    const auto frames = read_all(input);
    ASSERT_THAT(times_of(frames), ElementsAre(1000000, 2000000)) << input;
    EXPECT_TRUE(frames[0].is_readable());
    EXPECT_THAT(frames[1].error, HasSubstr("symbolic links"));
    EXPECT_THAT(frames[1].error, Not(HasSubstr("2000000.pgm")));  // which is the frame's name
  }
}

}  // namespace
}  // namespace apriltrack::test
