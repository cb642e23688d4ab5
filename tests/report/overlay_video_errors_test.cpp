#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/report/overlay_video.h"
#include "support/shared_data.h"
#include "video_encoder.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

template <class Act>
void expect_error(Act act, ErrorKind kind, const std::string& part, const std::string& also = "") {
  try {
    act();
    FAIL() << "no error that says " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(part));
    EXPECT_THAT(error.what(), HasSubstr(also));
  }
}

std::size_t count_files(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void add_grey_frame(OverlayVideo& video) {
  const GrayImage image(64, 48, 128);
  video.add({image.view(), {}, "", {}});
}

TEST(OverlayVideoErrors, OtherExtensionIsRefusedWithTheWayOut) {
  const auto folder = test::temporary_folder();
  expect_error([&] { OverlayVideo(folder / "video.avi", 64, 48, 30.0); }, ErrorKind::kInvalidInput,
               "video.avi", "ends in .mp4");
  expect_error([&] { OverlayVideo(folder / "video", 64, 48, 30.0); }, ErrorKind::kInvalidInput,
               "ends in .mp4");
  EXPECT_EQ(count_files(folder), 0u);
  EXPECT_NO_THROW(OverlayVideo(folder / "VIDEO.MP4", 64, 48, 30.0));
}

TEST(OverlayVideoErrors, UnwritablePlacesAreToldBeforeTheFirstFrame) {
  const auto folder = test::temporary_folder();
  expect_error([&] { OverlayVideo(folder / "missing" / "video.mp4", 64, 48, 30.0); }, ErrorKind::kIo,
               "missing/video.mp4: cannot be written", "No such file or directory");
  fs::create_directory(folder / "folder.mp4");
  expect_error([&] { OverlayVideo(folder / "folder.mp4", 64, 48, 30.0); }, ErrorKind::kIo, "folder.mp4",
               "it is a folder");
}

TEST(OverlayVideoErrors, FullDiskIsToldWhileEncoding) {
  const auto encode = [] {
    VideoEncoder encoder("/dev/full", "video.mp4", {320, 240, 30.0});
    cv::Mat noise(240, 320, CV_8UC3);
    cv::RNG random(7);
    for (int i = 0; i < 60; ++i) {
      random.fill(noise, cv::RNG::UNIFORM, 0, 256);
      encoder.add(noise);
    }
    encoder.finish();
  };
  expect_error(encode, ErrorKind::kIo, "video.mp4: cannot be written", "No space left on device");
}

TEST(OverlayVideoErrors, FullDiskIsToldWhenClosing) {
  const auto folder = test::temporary_folder();
  fs::create_symlink("/dev/full", folder / "video.mp4");
  OverlayVideo video(folder / "video.mp4", 64, 48, 30.0);
  add_grey_frame(video);
  expect_error([&] { video.close(); }, ErrorKind::kIo, "video.mp4: cannot be written",
               "No space left on device");
}

TEST(OverlayVideoErrors, MissingEncoderIsToldWithTheWayOut) {
  const auto folder = test::temporary_folder();
  const char* const encoders[] = {"no_such_encoder"};
  expect_error(
      [&] {
        VideoEncoder(folder / "x.new", "video.mp4", {64, 48, 30.0}, encoders);
      },
      ErrorKind::kIo,
      "video.mp4: cannot be written: this FFmpeg has no H.264 encoder (looked for no_such_encoder)",
      "leave the video out");
}

TEST(OverlayVideoErrors, WhatIsNotClosedLeavesTheOldFile) {
  const auto folder = test::temporary_folder();
  const auto file = folder / "video.mp4";
  std::ofstream(file) << "old";
  {
    OverlayVideo video(file, 64, 48, 30.0);
    for (int i = 0; i < 5; ++i) add_grey_frame(video);
    EXPECT_EQ(read_file(file), "old");
  }
  EXPECT_EQ(read_file(file), "old");
  EXPECT_EQ(count_files(folder), 1u) << "and nothing beside it";
}

TEST(OverlayVideoErrors, ClosedVideoIsTheOnlyFile) {
  const auto folder = test::temporary_folder();
  OverlayVideo video(folder / "video.mp4", 64, 48, 30.0);
  add_grey_frame(video);
  video.close();
  EXPECT_THAT(read_file(folder / "video.mp4").substr(4, 4), "ftyp");
  OverlayVideo other(folder / "other.mp4", 64, 48, 30.0);
  other = std::move(video);  // a video that is given up on takes its files with it
  EXPECT_EQ(count_files(folder), 1u);
}

TEST(OverlayVideoErrors, VideoWithoutFramesIsNoResult) {
  const auto folder = test::temporary_folder();
  {
    OverlayVideo video(folder / "video.mp4", 64, 48, 30.0);
    expect_error([&] { video.close(); }, ErrorKind::kNoResult, "video.mp4: was not written", "no frame");
  }
  EXPECT_EQ(count_files(folder), 0u);
}

TEST(OverlayVideoErrors, MisuseIsRefused) {
  const auto file = test::temporary_folder() / "video.mp4";
  EXPECT_THROW(OverlayVideo(file, 0, 48, 30.0), MisuseError);
  EXPECT_THROW(OverlayVideo(file, 64, -2, 30.0), MisuseError);
  EXPECT_THROW(OverlayVideo(file, 64, 48, 0.0), MisuseError);
  EXPECT_THROW(OverlayVideo(file, 64, 48, std::numeric_limits<double>::quiet_NaN()), MisuseError);
  OverlayVideo video(file, 64, 48, 30.0);
  const GrayImage other_size(48, 64);
  EXPECT_THROW(video.add({other_size.view(), {}, "", {}}), MisuseError);
  add_grey_frame(video);
  video.close();
  EXPECT_THROW(add_grey_frame(video), MisuseError);
  EXPECT_THROW(video.close(), MisuseError);
}

}  // namespace
}  // namespace apriltrack
