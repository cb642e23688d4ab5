// A recorder that repeats pictures under times of their own: told as that, and not as a wrong exposure or a
// gap. And a body of tags before a camera at rest that is tracked as a world of tags.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/source/image_file.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using testing::HasSubstr;
using testing::Not;

std::vector<fs::path> frames_of(const fs::path& recording) {
  std::vector<fs::path> frames;
  for (const auto& entry : fs::directory_iterator(recording / "frames")) frames.push_back(entry.path());
  std::ranges::sort(frames, {}, [](const fs::path& frame) { return std::stoll(frame.stem()); });
  return frames;
}

/// The same picture, a microsecond later.
void repeat(const fs::path& frame) {
  const long long time_ns = std::stoll(frame.stem()) + 1000;
  fs::copy_file(frame, frame.parent_path() / fmt::format("{:019}{}", time_ns, frame.extension().string()));
}

/// Ten frames of a room, of which the fourth and the eighth are there twice.
class CopiedFrames : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!folder_.empty()) return;
    folder_ = temporary_folder();
    run_for_json({"simulate", "--scene", "room", "--frames", "10", "--output", film()});
    const std::vector<fs::path> frames = frames_of(film());
    for (const std::size_t i : {3, 7}) repeat(frames.at(i));
  }
  static std::string film() { return folder_ / "film"; }
  static std::string path(const std::string& name) { return folder_ / name; }

  static inline fs::path folder_;
};

TEST_F(CopiedFrames, AreToldByTrackInsteadOfTheExposure) {
  const ProgramRun run = run_program(
      {"track", film(), "--method", "pnp", "--output", path("out.tum"), "--report", path("page.html")});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, HasSubstr("2 of 12 frames are copies of the frame before"));
  EXPECT_THAT(run.err, Not(HasSubstr("is longer than")));
  EXPECT_THAT(run.err, Not(HasSubstr("exposure_time")));
  EXPECT_THAT(read_text(path("page.html")), HasSubstr("2 of 12 frames are copies of the frame before"));
  EXPECT_EQ(
      run_for_json({"track", film(), "--method", "pnp", "--output", path("again.tum")})["copied_frames"], 2);
}

TEST_F(CopiedFrames, AreToldByCalibrate) {
  const nlohmann::json told =
      run_for_json({"calibrate", film(), "--tag-size", "0.16", "--output", path("map.yaml"), "--no-refine"});
  EXPECT_EQ(told["copied_frames"], 2);
}

TEST_F(CopiedFrames, AreAFindingOfDoctorAndNoGap) {
  const nlohmann::json told = run_for_json({"doctor", film()});
  const auto about = [&](const std::string& what) {
    return std::ranges::any_of(told["findings"],
                               [&](const nlohmann::json& one) { return one["about"] == what; });
  };
  EXPECT_TRUE(about("copied_frames"));
  EXPECT_FALSE(about("time_gaps"));
  EXPECT_FALSE(about("times_not_forward"));
}

TEST_F(CopiedFrames, AreNoneWhereTheSensorsNoiseDiffers) {
  run_for_json({"simulate", "--scene", "room", "--frames", "4", "--speed", "0", "--output", path("still")});
  const ProgramRun run =
      run_program({"track", path("still"), "--method", "pnp", "--output", path("still.tum")});
  EXPECT_THAT(run.err, Not(HasSubstr("copies")));
}

TEST(TrackedMode, OfABodyBeforeACameraAtRestIsAskedFor) {
  const fs::path folder = temporary_folder();
  run_for_json(
      {"simulate", "--scene", "bundle", "--frames", "60", "--speed", "1", "--output", folder / "film"});
  const auto track = [&](const std::string& mode) {
    return run_program(
        {"track", folder / "film", "--mode", mode, "--method", "pnp", "--output", folder / "out.tum"});
  };
  EXPECT_THAT(track("ego"), EndsWith(0, "with --mode joint they are T_camera_body"));
  EXPECT_THAT(track("joint").err, Not(HasSubstr("--mode joint")));
}

/// What rectification leaves beyond a picture's edge, and a fisheye beside its circle.
void blacken_rim(const fs::path& frame) {
  GrayImage image = read_image(frame);
  const double middle_x = 0.5 * (image.width() - 1), middle_y = 0.5 * (image.height() - 1);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (std::hypot((x - middle_x) / middle_x, (y - middle_y) / middle_y) > 0.8) image(x, y) = 0;
  write_image(frame, image.view());
}

TEST(TrackedMode, OfACameraInARoomIsNotDoubted) {
  const fs::path folder = temporary_folder();
  run_for_json(
      {"simulate", "--scene", "room", "--frames", "60", "--speed", "1", "--output", folder / "film"});
  for (const bool has_black_rim : {false, true}) {
    if (has_black_rim) std::ranges::for_each(frames_of(folder / "film"), blacken_rim);
    const ProgramRun run =
        run_program({"track", folder / "film", "--method", "pnp", "--output", folder / "out.tum"});
    EXPECT_EQ(run.status, 0);
    EXPECT_THAT(run.err, Not(HasSubstr("stands still"))) << has_black_rim;
  }
}

}  // namespace
}  // namespace apriltrack::test
