#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <cmath>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "apriltrack/image/opencv_bridge.h"
#include "apriltrack/io/atomic_file.h"
#include "source_support.h"
#include "support/judges.h"
#include "support/shared_data.h"
#include "video_files.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr double kMaxCodingError = 4.0;  // grey levels; JPEG at 98, MPEG-4 at its finest

/// Plain grey, so that a frame's level tells which picture it is.
VideoPlan plan_of_levels(const std::vector<std::int64_t>& times_ticks) {
  VideoPlan plan;
  for (std::size_t i = 0; i < times_ticks.size(); ++i)
    plan.pictures.emplace_back(kWidth, kHeight, static_cast<std::uint8_t>(5 + 15 * i));
  plan.times_ticks = times_ticks;
  return plan;
}

std::vector<std::int64_t> nanoseconds_of(const std::vector<std::int64_t>& times_ticks) {
  std::vector<std::int64_t> times;
  for (const std::int64_t ticks : times_ticks)
    times.push_back((2 * ticks * 1'000'000'000 + kTicksPerSecond) /
                    (2 * kTicksPerSecond));  // rounded, in integers
  return times;
}

double level_of(const SourceFrame& frame) {
  return cv::mean(mat_of(frame.pixels.view()))[0];
}

// Nothing like a constant rate: from 5 ms to 1 s between frames.
const std::vector<std::int64_t> kIrregular = {0,      450,    3453,   6003,   96003,  97000,
                                              100001, 110000, 110900, 140000, 140450, 150001};

TEST(Video, KeepsIrregularTimesToTheNanosecond) {
  const auto path = temporary_folder() / "irregular.mov";
  write_mjpeg_video(path, plan_of_levels(kIrregular));
  const auto frames = read_all(path.string());
  EXPECT_EQ(times_of(frames), nanoseconds_of(kIrregular));
  EXPECT_EQ(open_source(path.string())->num_frames(), kIrregular.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_NEAR(level_of(frames[i]), 5.0 + 15.0 * static_cast<double>(i), kMaxCodingError);
}

/// A playlist (RFC 8216), with a byte that no text has: FFmpeg would go on to what it names.
TEST(Video, OpensNoOtherFileThatItNames) {
  const auto folder = temporary_folder();
  write_mjpeg_video(folder / "other.mov", plan_of_levels(kIrregular));
  write_text(folder / "list.mkv", "#EXTM3U\n#EXT-X-TARGETDURATION:9\n#EXTINF:9,\n" +
                                      (folder / "other.mov").string() + "\n#EXT-X-ENDLIST\n\x01");
  expect_refused(folder / "list.mkv", ErrorKind::kIo, {"list.mkv"});
}

TEST(Video, KeepsTimesOfMatroskaToItsMillisecond) {
  const auto path = temporary_folder() / "irregular.mkv";
  std::vector<std::int64_t> times_ticks = kIrregular;
  for (std::int64_t& ticks : times_ticks) ticks = ticks / 90 * 90;
  write_mjpeg_video(path, plan_of_levels(times_ticks));
  EXPECT_EQ(times_of(read_all(path.string())), nanoseconds_of(times_ticks));
}

TEST(Video, JoinsEachPictureWithItsOwnTimeWhereStoredInAnotherOrder) {
  std::vector<std::int64_t> times_ticks = kIrregular;
  for (std::int64_t& ticks : times_ticks) ticks = ticks / 3 * 3;  // the codec's own ticks are 1/30000 s
  const auto path = temporary_folder() / "b_frames.mov";
  write_b_frame_video(path, plan_of_levels(times_ticks));
  const auto frames = read_all(path.string());
  ASSERT_EQ(frames.size(), times_ticks.size());
  EXPECT_EQ(times_of(frames), nanoseconds_of(times_ticks));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_TRUE(frames[i].is_readable()) << frames[i].error;
    EXPECT_NEAR(level_of(frames[i]), 5.0 + 15.0 * static_cast<double>(i), kMaxCodingError) << "frame " << i;
  }
}

/// What is read of a pipe into which the file is written.
std::vector<SourceFrame> read_all_by_pipe(const fs::path& path) {
  const fs::path pipe = path.string() + ".pipe";
  EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::jthread writer([&] { std::ofstream(pipe, std::ios::binary) << read_file(path); });
  return read_all(pipe.string());
}

// FFmpeg tells of such a stream no start, and later one that is the time of a later frame.
TEST(Video, HasTheTimesOfItsFileByAPipe) {
  APRILTRACK_NEED_JUDGE(
      Judge{"FFmpeg's encoder of H.264", "libx264, with an FFmpeg that has it", can_write_h264()});
  std::vector<std::int64_t> times_ticks;
  for (std::int64_t i = 0; i < 40; ++i) times_ticks.push_back(3000 * i);
  VideoPlan plan;
  for (int i = 0; i < 40; ++i)
    plan.pictures.emplace_back(kWidth, kHeight, static_cast<std::uint8_t>(40 + 5 * i));
  const fs::path folder = temporary_folder();
  for (const char* name : {"live.mkv", "live.ts"}) {
    const fs::path path = folder / name;
    plan.times_ticks = times_ticks;
    write_live_h264_video(path, plan);
    const auto by_pipe = read_all_by_pipe(path);
    ASSERT_EQ(by_pipe.size(), 40U) << name;
    for (std::size_t i = 0; i < by_pipe.size(); ++i) {
      EXPECT_TRUE(by_pipe[i].is_readable()) << name << ": " << by_pipe[i].error;
      EXPECT_NEAR(static_cast<double>(by_pipe[i].timestamp.ns),
                  static_cast<double>(times_ticks[i]) * 1e9 / 90e3, 1e6)
          << name << " frame " << i << ": Matroska has milliseconds";
    }
  }
}

TEST(Video, SpreadsItsRangeFromBlackToWhite) {
  VideoPlan plan;
  for (const std::uint8_t level : {0, 128, 255}) plan.pictures.emplace_back(kWidth, kHeight, level);
  plan.times_ticks = {0, 3000, 6000};
  const auto folder = temporary_folder();
  const auto full = folder / "full.mov";
  const auto narrow = folder / "narrow.mov";
  write_mjpeg_video(full, plan);
  write_b_frame_video(narrow, plan);
  for (const fs::path& path : {full, narrow}) {
    const auto frames = read_all(path.string());
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_NEAR(level_of(frames[0]), 0.0, kMaxCodingError) << path;
    EXPECT_NEAR(level_of(frames[1]), 128.0, kMaxCodingError) << path;
    EXPECT_NEAR(level_of(frames[2]), 255.0, kMaxCodingError) << path;
  }
}

TEST(Video, KeepsEveryPixelOfAnOddWidth) {
  GrayImage ramp(61, 47);
  for (int y = 0; y < 47; ++y) {
    for (int x = 0; x < 61; ++x) ramp(x, y) = static_cast<std::uint8_t>(3 * x + y);
  }
  const auto path = temporary_folder() / "odd.mov";
  write_mjpeg_video(path, {.pictures = {ramp}, .times_ticks = {0}});
  const GrayImage image = read_all(path.string()).at(0).pixels;
  ASSERT_EQ(image.width(), 61);
  ASSERT_EQ(image.height(), 47);
  for (int y = 0; y < 47; ++y) {
    for (int x = 0; x < 61; ++x) ASSERT_NEAR(image(x, y), ramp(x, y), kMaxCodingError) << x << ", " << y;
  }
}

TEST(Video, StandsUprightAsTheFileSays) {
  // Brighter to the right; turned clockwise it is brighter to the bottom.
  GrayImage ramp(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) ramp(x, y) = static_cast<std::uint8_t>(3 * x + y);
  }
  const auto folder = temporary_folder();
  const auto first_frame = [&](int turn_deg) {
    const auto path = folder / (std::to_string(turn_deg) + ".mov");
    write_mjpeg_video(path,
                      {.pictures = {ramp, ramp}, .times_ticks = {0, 3000}, .turn_clockwise_deg = turn_deg});
    return read_all(path.string()).at(0).pixels;
  };
  const GrayImage plain = first_frame(0);
  const GrayImage quarter = first_frame(90);
  const GrayImage half = first_frame(180);
  const GrayImage three_quarters = first_frame(270);
  ASSERT_EQ(plain.width(), kWidth);
  ASSERT_EQ(quarter.width(), kHeight);
  ASSERT_EQ(quarter.height(), kWidth);
  ASSERT_EQ(half.width(), kWidth);
  ASSERT_EQ(three_quarters.width(), kHeight);
  for (const auto& [x, y] : {std::pair(5, 7), std::pair(60, 40), std::pair(0, 47)}) {
    EXPECT_NEAR(plain(x, y), ramp(x, y), kMaxCodingError);
    EXPECT_NEAR(quarter(kHeight - 1 - y, x), ramp(x, y), kMaxCodingError);
    EXPECT_NEAR(half(kWidth - 1 - x, kHeight - 1 - y), ramp(x, y), kMaxCodingError);
    EXPECT_NEAR(three_quarters(y, kWidth - 1 - x), ramp(x, y), kMaxCodingError);
  }
}

TEST(Video, CanBeSampledWithoutLosingTimes) {
  const auto path = temporary_folder() / "irregular.mov";
  write_mjpeg_video(path, plan_of_levels(kIrregular));
  const auto frames = read_all(path.string(), {.skip = 1, .step = 4});
  EXPECT_EQ(times_of(frames), nanoseconds_of({kIrregular[1], kIrregular[5], kIrregular[9]}));
  EXPECT_THAT(frames[1].name, HasSubstr("irregular.mov frame 5"));
  EXPECT_NEAR(level_of(frames[1]), 5.0 + 15.0 * 5.0, kMaxCodingError);
}

TEST(Video, HandsOutADamagedFrameAsUnreadableAndGoesOn) {
  const auto path = temporary_folder() / "damaged.mov";
  VideoPlan plan = plan_of_levels(kIrregular);
  plan.damaged_picture = 4;
  write_mjpeg_video(path, plan);
  const auto frames = read_all(path.string());
  ASSERT_EQ(frames.size(), kIrregular.size());
  EXPECT_EQ(times_of(frames), nanoseconds_of(kIrregular));
  for (std::size_t i = 0; i < frames.size(); ++i)
    EXPECT_EQ(frames[i].is_readable(), i != 4) << frames[i].error;
  EXPECT_THAT(frames[4].name, HasSubstr("damaged.mov frame 4"));
  EXPECT_THAT(frames[4].error, ::testing::StartsWith("cannot be decoded"));
}

TEST(Video, WithoutTimesNeedsARate) {
  const auto path = temporary_folder() / "raw.mjpeg";  // JPEGs one after the other, no container
  write_mjpeg_video(path, plan_of_levels({0, 1, 2, 3}));
  expect_refused(path, ErrorKind::kInvalidInput, {"raw.mjpeg", "no times", "--rate HZ"});
  const auto frames = read_all(path.string(), {.rate_hz = 30.0});
  EXPECT_THAT(times_of(frames), ::testing::ElementsAre(0, 33333333, 66666667, 100000000));
}

TEST(Video, WithTimesIsNoFilmOfAnotherRate) {
  const auto path = temporary_folder() / "film.mp4";
  write_mjpeg_video(path, plan_of_levels({0, 3000, 6000, 9000, 12000}));  // 5 frames in 4 steps
  for (const double rate_hz : {600.0, 9.0})
    expect_refused(path, ErrorKind::kInvalidInput, {"37.5 a second", "--rate", "-itsscale"},
                   {.rate_hz = rate_hz});
  EXPECT_EQ(times_of(read_all(path.string(), {.rate_hz = 25.0})), times_of(read_all(path.string())));
}

TEST(Video, WithoutAFrameIsAnError) {
  const auto path = temporary_folder() / "none.mkv";
  write_mjpeg_video(path, {});
  expect_refused(path, ErrorKind::kIo, {"none.mkv"});
}

TEST(Video, CutBeforeItsIndexIsAnError) {
  const auto path = temporary_folder() / "cut.mov";
  write_mjpeg_video(path, plan_of_levels(kIrregular));
  const std::string whole = read_bytes(path);
  write_text(path, whole.substr(0, whole.size() / 2));
  expect_refused(path, ErrorKind::kIo, {"cut.mov", "neither an image nor a video"});
}

/// What a source says of a video that is read to its end.
std::vector<std::string> told_of(const fs::path& path, const std::string& bytes) {
  write_text(path, bytes);
  std::vector<std::string> told;
  read_all(path.string(), {.log = [&](LogLevel, std::string_view text) { told.emplace_back(text); }});
  return told;
}

TEST(Video, CutBehindItsHeaderIsToldOfWithTheFramesThatAreThere) {
  const auto path = temporary_folder() / "cut.avi";
  constexpr std::size_t kNumFrames = 6, kNumWhole = 4;
  write_mjpeg_video(path, plan_of_levels({0, 1, 2, 3, 4, 5}));
  const std::string whole = read_bytes(path);
  EXPECT_THAT(told_of(path, whole), ::testing::IsEmpty());
  std::size_t chunk = whole.find("movi");
  for (std::size_t i = 0; i <= kNumWhole; ++i) chunk = whole.find("00dc", chunk + 4);
  ASSERT_NE(chunk, std::string::npos);
  for (const std::size_t into_the_next : {0, 4, 60}) {
    EXPECT_THAT(told_of(path, whole.substr(0, chunk + into_the_next)),
                ::testing::ElementsAre(
                    path.string() + ": the file is cut off or damaged: " + std::to_string(kNumWhole) +
                    " of the " + std::to_string(kNumFrames) + " frames that its header promises are there"));
  }
}

/// Its header counts no frames, but tells how long they go on.
TEST(Video, OfMatroskaThatIsCutIsToldOfWithBothDurations) {
  const auto path = temporary_folder() / "cut.mkv";
  constexpr std::int64_t kNumFrames = 16;  // at 4 Hz
  std::vector<std::int64_t> times_ticks;
  for (std::int64_t i = 0; i < kNumFrames; ++i) times_ticks.push_back(i * kTicksPerSecond / 4);
  write_mjpeg_video(path, plan_of_levels(times_ticks));
  const std::string whole = read_bytes(path);
  EXPECT_THAT(told_of(path, whole), ::testing::IsEmpty());
  const std::vector<std::string> told = told_of(path, whole.substr(0, whole.size() / 2));
  const std::size_t num_there = read_all(path.string()).size();
  ASSERT_GT(num_there, 4U);
  ASSERT_LT(num_there, 12U);
  EXPECT_THAT(told,
              ::testing::ElementsAre(fmt::format(
                  "{}: the file is cut off or damaged: its {} frames end after {:.1f} of the 3.8 s that its "
                  "header promises",
                  path.string(), num_there, 0.25 * static_cast<double>(num_there - 1))));
}

TEST(Video, OfAPhoneHasItsRecordedSizeAndTimes) {
  APRILTRACK_SHARED_OR_SKIP(path, "data/phone_page_blur/video.mp4");
  std::vector<std::string> told;
  const auto source =
      open_source(path.string(), {.log = [&](LogLevel, std::string_view text) { told.emplace_back(text); }});
  std::int64_t number = 0;
  for (; const auto frame = source->next(); ++number) {
    ASSERT_TRUE(frame->is_readable()) << frame->error;
    ASSERT_EQ(frame->pixels.width(), 480);
    ASSERT_EQ(frame->pixels.height(), 640);
    ASSERT_NEAR(static_cast<double>(frame->timestamp.ns), static_cast<double>(number) * 1e9 / 30.0, 1.0);
  }
  EXPECT_EQ(number, 886);
  EXPECT_THAT(told, ::testing::IsEmpty());
}

TEST(Video, OfAFieldIsWholeAndGreyAsOpenCvSeesIt) {
  APRILTRACK_SHARED_OR_SKIP(path, "data/wpical_field/video.mp4");
  cv::VideoCapture capture(path.string(), cv::CAP_FFMPEG);
  const auto source = open_source(path.string());
  std::int64_t last_ns = -1;
  int number = 0;
  double worst_difference = 0.0;
  for (; const auto frame = source->next(); ++number) {
    ASSERT_TRUE(frame->is_readable()) << frame->error;
    ASSERT_GT(frame->timestamp.ns, last_ns);
    last_ns = frame->timestamp.ns;
    cv::Mat colour, gray;
    ASSERT_TRUE(capture.read(colour));
    if (number % 20 != 0) continue;
    cv::cvtColor(colour, gray, cv::COLOR_BGR2GRAY);
    ASSERT_EQ(gray.size(), cv::Size(frame->pixels.width(), frame->pixels.height()));
    worst_difference = std::max(worst_difference, cv::norm(gray, mat_of(frame->pixels.view()), cv::NORM_L1) /
                                                      static_cast<double>(gray.total()));
  }
  EXPECT_EQ(number, 159);
  EXPECT_LT(worst_difference, 1.0);  // grey levels: two roads from luma to grey, rounded on the way
  EXPECT_EQ(last_ns,
            5300000000);  // 81408 ticks of 1/15360 s in the file: one frame of 160 was dropped on the way
}

}  // namespace
}  // namespace apriltrack::test
