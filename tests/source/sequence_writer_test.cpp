#include "apriltrack/source/sequence_writer.h"

#include <gmock/gmock.h>

#include <thread>

#include "source_support.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

namespace fs = std::filesystem;

TEST(SequenceWriter, NamesThatAreSortedAsTextAreSortedByTime) {
  EXPECT_EQ(sequence_frame_name({95}), "0000000000000000095.png");
  EXPECT_EQ(sequence_frame_name({9'223'372'036'854'775'807}), "9223372036854775807.png");
}

TEST(SequenceWriter, WritesWhatOpenSourceReads) {
  const auto folder = temporary_folder() / "deep" / "new";
  const SequenceWriter writer(folder, false);
  const std::vector<GrayImage> images = {test_picture(8, 6, 1), test_picture(8, 6, 2)};
  const std::vector<Frame> frames = {
      {.image = images[0].view(), .timestamp = {95}, .exposure_s = 0.1, .gain = 1.0},
      {.image = images[1].view(),
       .timestamp = {1000000000000000123},
       .exposure_s = std::nullopt,
       .gain = 1.0 / 3.0}};
  for (const Frame& frame : frames) writer.write_frame(frame);
  writer.write_frames_csv(frames);

  EXPECT_EQ(read_bytes(folder / "frames.csv"),
            "timestamp_ns,exposure_s,gain\n95,0.1,1\n1000000000000000123,,0.3333333333333333\n");
  const auto back = read_all(folder.string());
  ASSERT_THAT(times_of(back), ::testing::ElementsAre(95, 1000000000000000123));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_THAT(back[i].pixels, SamePixels(images[i]));
    EXPECT_EQ(back[i].exposure_s, frames[i].exposure_s);
    EXPECT_EQ(back[i].gain, frames[i].gain);
  }
}

TEST(SequenceWriter, TakesFramesFromSeveralThreads) {
  const auto folder = temporary_folder() / "new";
  const SequenceWriter writer(folder, false);
  constexpr int kThreads = 4;
  constexpr int kFramesEach = 8;
  constexpr std::int64_t kPeriod_ns = 1'000'000;
  const auto write_some = [&](int first) {
    for (int i = 0; i < kFramesEach; ++i) {
      const int time = first * kFramesEach + i;
      const GrayImage image = test_picture(16, 12, time);
      writer.write_frame(
          {.image = image.view(), .timestamp = {kPeriod_ns * time}, .exposure_s = std::nullopt});
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) threads.emplace_back(write_some, i);
  for (std::thread& thread : threads) thread.join();
  const auto back = read_all(folder.string());
  ASSERT_EQ(back.size(), kThreads * kFramesEach);
  for (int i = 0; i < kThreads * kFramesEach; ++i)
    EXPECT_THAT(back[static_cast<std::size_t>(i)].pixels, SamePixels(test_picture(16, 12, i)));
}

TEST(SequenceWriter, LeavesAFullFolderAloneUnlessToldOtherwise) {
  const auto folder = temporary_folder();
  write_text(folder / "thesis.txt", "precious");
  write_text(folder / "truth.tum", "old");
  write_pgm(folder / "frames" / "5.pgm", test_picture(4, 4));
  write_pgm(folder / "frames" / "holiday.pgm", test_picture(4, 4));
  expect_error(ErrorKind::kIo, {folder.string(), "not empty"}, [&] { SequenceWriter(folder, false); });
  EXPECT_TRUE(fs::exists(folder / "truth.tum"));

  const SequenceWriter writer(folder, true);
  EXPECT_FALSE(fs::exists(folder / "truth.tum"));  // of the old sequence: it would not fit the new frames
  EXPECT_FALSE(fs::exists(folder / "frames" / "5.pgm"));  // likewise
  EXPECT_TRUE(fs::exists(folder / "thesis.txt"));
  EXPECT_TRUE(fs::exists(folder / "frames" / "holiday.pgm"));
}

TEST(SequenceWriter, SaysWhyAFolderCannotBeMade) {
  const auto file = temporary_folder() / "file";
  write_text(file, "x");
  expect_error(ErrorKind::kIo, {"file"}, [&] { SequenceWriter(file, false); });
  expect_error(ErrorKind::kIo, {"file", "sub"}, [&] { SequenceWriter(file / "sub", true); });
}

}  // namespace
}  // namespace apriltrack::test
