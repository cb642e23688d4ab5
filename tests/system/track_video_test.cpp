// `track --video`: the outlines lie where the tags truly are, and no film of another's is replaced.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "apriltrack/camera/camera.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/source/sequence_writer.h"
#include "apriltrack/tags/tag_map.h"
#include "decoded_video.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

bool is_outline(const cv::Vec3b& bgr) {
  constexpr std::array<int, 3> kDetected = {115, 158, 0};
  constexpr int kTolerance = 60;  // colours have half the resolution, and the codec
  for (int c = 0; c < 3; ++c)
    if (std::abs(bgr[c] - kDetected[static_cast<std::size_t>(c)]) > kTolerance) return false;
  return true;
}

bool has_outline_near(const cv::Mat& bgr, const Eigen::Vector2d& at, int reach) {
  const cv::Rect window(cvRound(at.x()) - reach, cvRound(at.y()) - reach, 2 * reach + 1, 2 * reach + 1);
  const cv::Mat part = bgr(window & cv::Rect({}, bgr.size()));
  return std::any_of(part.begin<cv::Vec3b>(), part.end<cv::Vec3b>(), is_outline);
}

/// A slow film of a scene, in which every frame is detected, and its video.
struct SlowFilm {
  SlowFilm(const std::string& scene, const std::string& mode) {
    run_for_json({"simulate", "--scene", scene, "--frames", "5", "--speed", "0.2", "--exposure", "0.002",
                  "--output", film});
    camera = read_cameras(film + "/camera.yaml").cameras.front();
    map = read_tag_map(film + "/map.yaml");
    for (const TimedPose& pose : read_tum(film + "/truth.tum"))
      T_camera_map.push_back(mode == "ego" ? pose.pose.inverse() : pose.pose);
    const auto summary = run_for_json(
        {"track", film, "--mode", mode, "--method", "pnp", "--output", folder / "out.tum", "--video", video});
    EXPECT_EQ(summary["video"], video);
    EXPECT_EQ(summary["detected"], 5);
  }

  const fs::path folder = temporary_folder();
  const std::string film = folder / "film", video = folder / "out.mp4";
  Camera camera{.model = CameraModel({1, 1, 0, 0}, NoDistortion{})};
  TagMap map;
  std::vector<Pose> T_camera_map;
};

/// Middles of the edges of tags that face the camera and lie well inside the image.
std::vector<Eigen::Vector2d> edge_middles(const SlowFilm& film, const Pose& T_camera_map) {
  constexpr double kBorder_px = 60.0;
  const Eigen::AlignedBox2d inside(
      Eigen::Vector2d(kBorder_px, kBorder_px),
      Eigen::Vector2d(film.camera.width - kBorder_px, film.camera.height - kBorder_px));
  std::vector<Eigen::Vector2d> middles;
  for (const MapTag& tag : film.map.tags) {
    const Pose T_camera_tag = T_camera_map * tag.T_map_tag;
    const Eigen::Vector3d into_tag = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
    if (into_tag.dot(T_camera_tag.translation().normalized()) < 0.4) continue;
    const auto corners = corners_in_map(tag);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d middle = 0.5 * (corners[i] + corners[(i + 1) % 4]);
      const auto pixel = film.camera.model.project(T_camera_map * middle);
      if (pixel && inside.contains(*pixel)) middles.push_back(*pixel);
    }
  }
  return middles;
}

class TrackVideo : public ::testing::TestWithParam<std::array<const char*, 2>> {};

TEST_P(TrackVideo, OutlinesEveryTagWhereItTrulyIs) {
  const SlowFilm film(GetParam()[0], GetParam()[1]);
  const DecodedVideo video = decode_video(film.video);
  EXPECT_EQ(video.codec, "h264");
  ASSERT_EQ(video.frames.size(), film.T_camera_map.size());
  int judged = 0;
  for (std::size_t i = 0; i < video.frames.size(); ++i) {
    const cv::Mat& bgr = video.frames[i].bgr;
    const int bar_height = bgr.rows - film.camera.height;  // of the caption, above the picture
    EXPECT_GT(bar_height, 0);
    for (const Eigen::Vector2d& middle : edge_middles(film, film.T_camera_map[i])) {
      EXPECT_TRUE(has_outline_near(bgr, middle + Eigen::Vector2d(0.0, bar_height), 2))
          << "frame " << i << ", " << middle.transpose();
      ++judged;
    }
  }
  EXPECT_GE(judged, 20);
}

INSTANTIATE_TEST_SUITE_P(Scenes, TrackVideo,
                         ::testing::Values(std::array<const char*, 2>{"room-gentle", "ego"},
                                           std::array<const char*, 2>{"bundle", "joint"}),
                         [](const auto& shown) { return std::string(shown.param[1]); });

class TrackVideoFiles : public ::testing::Test {
 protected:
  TrackVideoFiles() { run_for_json({"simulate", "--scene", "single", "--frames", "3", "--output", film_}); }
  ProgramRun track(const std::string& video) {
    return run_program({"track", film_, "--mode", "joint", "--method", "pnp", "--output", folder_ / "out.tum",
                        "--video", video});
  }

  const fs::path folder_ = temporary_folder();
  const std::string film_ = folder_ / "film";
};

TEST_F(TrackVideoFiles, AreCheckedBeforeTheWork) {
  EXPECT_THAT(track(folder_ / "out.avi"), EndsWith(2, ".mp4"));
  EXPECT_THAT(track(folder_ / "nowhere" / "out.mp4"), EndsWith(3, "nowhere"));
  const fs::path mine = folder_ / "mine.mp4";
  std::ofstream(mine) << "my film";
  EXPECT_THAT(track(mine), EndsWith(2, "is a picture or video"));
  EXPECT_EQ(fs::file_size(mine), 7U);
  EXPECT_FALSE(fs::exists(folder_ / "out.tum"));
  EXPECT_THAT(run_program({"track", "--detections", folder_ / "x.csv", "--camera", "c.yaml", "--map",
                           "m.yaml", "--output", folder_ / "o.tum", "--video", folder_ / "o.mp4"}),
              EndsWith(2, "--video"));
}

/// What is told is told in our words, a line each: FFmpeg and OpenCV have nothing to say.
void expect_own_words(const ProgramRun& run) {
  std::istringstream lines(run.err);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(line.starts_with("warning: ") || line.starts_with("error: ")) << line;
}

TEST_F(TrackVideoFiles, ThatAreCutOrDamagedAreToldOfInOurWords) {
  constexpr std::size_t kNumFilmed = 12;
  run_for_json({"simulate", "--scene", "room-gentle", "--frames", std::to_string(kNumFilmed), "--output",
                folder_ / "room"});
  run_for_json({"track", folder_ / "room", "--method", "pnp", "--output", folder_ / "o.tum", "--video",
                folder_ / "whole.mp4"});
  const auto detect = [&](const char* name) {
    const ProgramRun run = run_program(
        {"detect", folder_ / name, "--response", "srgb", "--output", folder_ / "o.csv", "--json", "--quiet"});
    expect_own_words(run);
    return run;
  };
  EXPECT_EQ(detect("whole.mp4").err, "");
  const std::string whole = read_text(folder_ / "whole.mp4");
  write_text(folder_ / "cut.mp4", whole.substr(0, whole.size() * 2 / 3));
  const ProgramRun cut = detect("cut.mp4");
  EXPECT_THAT(
      cut, EndsWith(0, "warning: " + (folder_ / "cut.mp4").string() + ": the file is cut off or damaged: "));
  EXPECT_THAT(cut, EndsWith(0, " of the " + std::to_string(kNumFilmed) +
                                   " frames that its header promises are there"));
  std::string damaged = whole;  // in the pictures, which come last
  for (std::size_t i = 1; i < 40; ++i) damaged[damaged.size() - i * damaged.size() / 80] ^= 0x55;
  write_text(folder_ / "damaged.mp4", damaged);
  EXPECT_THAT(detect("damaged.mp4"), EndsWith(0, "the data is damaged"));
  write_text(folder_ / "head.mp4", whole.substr(0, 300));
  EXPECT_THAT(detect("head.mp4"), EndsWith(3, "head.mp4"));
  const ProgramRun live = run_program({"detect", "camera:254", "--output", folder_ / "o.csv", "--quiet"});
  EXPECT_THAT(live, EndsWith(3, "camera:254: no camera there"));
  expect_own_words(live);
}

TEST_F(TrackVideoFiles, KeepThePlaceOfAnUnreadableFrame) {
  const Trajectory truth = read_tum(film_ + "/truth.tum");
  const fs::path second = fs::path(film_) / "frames" / sequence_frame_name(truth[1].timestamp);
  ASSERT_TRUE(fs::exists(second));
  std::ofstream(second, std::ios::trunc) << "no picture";
  EXPECT_EQ(track(folder_ / "gap.mp4").status, 0);
  EXPECT_EQ(decode_video(folder_ / "gap.mp4").frames.size(), 3U);
}

TEST_F(TrackVideoFiles, ThatDoNotFitOnTheDiskLeaveTheOtherOutputsAlone) {
  constexpr std::size_t kOnlyTheFilmIsLarger = 5'000;
  const fs::path out = folder_ / "out.tum", video = folder_ / "out.mp4";
  ASSERT_EQ(track(video).status, 0);
  ASSERT_LT(fs::file_size(out), kOnlyTheFilmIsLarger);
  ASSERT_GT(fs::file_size(video), kOnlyTheFilmIsLarger);
  fs::remove(video);
  std::ofstream(out) << "old";
  EXPECT_THAT(run_program_on_full_disk({"track", film_, "--mode", "joint", "--method", "pnp", "--output", out,
                                        "--video", video, "--frames-csv", folder_ / "frames.csv", "--quiet"},
                                       kOnlyTheFilmIsLarger),
              EndsWith(3, "error: " + video.string() + ": cannot be written: "));
  EXPECT_EQ(read_text(out), "old");
  std::set<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder_)) left.insert(entry.path().filename().string());
  EXPECT_EQ(left, (std::set<std::string>{"film", "out.tum"}));
}

TEST_F(TrackVideoFiles, AreNotLeftByARunWithoutAPose) {
  run_for_json({"simulate", "--scene", "room", "--frames", "3", "--output", folder_ / "room"});
  const ProgramRun run =
      run_program({"track", folder_ / "room", "--method", "pnp", "--map", film_ + "/map.yaml", "--output",
                   folder_ / "none.tum", "--video", folder_ / "none.mp4"});
  EXPECT_NE(run.status, 0);
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_NE(entry.path().filename().string().substr(0, 4), "none") << entry.path();
}

}  // namespace
}  // namespace apriltrack::test
