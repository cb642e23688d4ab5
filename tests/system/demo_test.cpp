// The demo: its figures are those of `evaluate` and of plain arithmetic, and its page holds all of it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>

#include "decoded_video.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

std::size_t count_of(const std::string& words, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
  return count;
}

/// Of `simulate`'s single scene, read off its files: one tag of 0.16 m at the body's origin before a pinhole.
constexpr double kFocal_px = 1000.0;
const Eigen::Vector2d kMiddle_px(639.5, 359.5), kSize_px(1280.0, 720.0);
constexpr double kHalfTag_m = 0.08;

/// By time in ns, T_camera_body.
std::map<long long, Eigen::Isometry3d> poses_of(const fs::path& tum) {
  std::map<long long, Eigen::Isometry3d> poses;
  std::istringstream lines(read_text(tum));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream numbers(line);
    std::string time;
    Eigen::Vector3d t;
    Eigen::Quaterniond q;
    numbers >> time >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w();
    EXPECT_TRUE(numbers) << line;
    time.erase(time.find('.'), 1);  // seconds with nine decimals
    poses[std::stoll(time)] = Eigen::Translation3d(t) * q.normalized();
  }
  return poses;
}

/// By time in ns: `detected`, `tracked`, ...
std::map<long long, std::string> statuses_of(const fs::path& frame_log) {
  std::map<long long, std::string> statuses;
  std::istringstream lines(read_text(frame_log));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.rfind("timestamp_ns,status,", 0), 0U) << line;
  while (std::getline(lines, line)) {
    const std::size_t comma = line.find(',');
    statuses[std::stoll(line)] = line.substr(comma + 1, line.find(',', comma + 1) - comma - 1);
  }
  return statuses;
}

Eigen::Vector2d pixel(const Eigen::Vector3d& point) {
  return kFocal_px * point.head<2>() / point.z() + kMiddle_px;
}

/// The frame counts: the tag's middle lies in the image, its face is turned to the camera by under 80
/// degrees.
bool is_seen(const Eigen::Isometry3d& T_camera_tag) {
  const Eigen::Vector3d middle = T_camera_tag.translation();
  const Eigen::Vector2d at = pixel(middle);
  const double cosine = T_camera_tag.rotation().col(2).dot(middle.normalized());
  return middle.z() > 0.1 && (at.array() >= 0.0).all() && (at.array() < kSize_px.array()).all() &&
         cosine >= std::cos(80.0 * std::numbers::pi / 180.0);
}

double corner_error_px(const Eigen::Isometry3d& truth, const Eigen::Isometry3d& estimate) {
  double sum = 0.0;
  for (const double u : {-kHalfTag_m, kHalfTag_m}) {
    for (const double v : {-kHalfTag_m, kHalfTag_m})
      sum +=
          (pixel(truth * Eigen::Vector3d(u, v, 0.0)) - pixel(estimate * Eigen::Vector3d(u, v, 0.0))).norm();
  }
  return sum / 4.0;
}

/// What a method's files say, counted frame by frame.
struct Counts {
  int frames = 0, claimed = 0, silent_failures = 0, within_5px = 0, with_pose = 0;
};

Counts count_single(const fs::path& demo, const std::string& method) {
  const auto truth = poses_of(demo / "single" / "truth.tum");
  const auto found = poses_of(demo / fmt::format("single_{}.tum", method));
  const auto statuses = statuses_of(demo / fmt::format("single_{}_frames.csv", method));
  Counts counts;
  for (const auto& [time_ns, pose] : truth) {
    if (!is_seen(pose)) continue;
    ++counts.frames;
    const auto estimate = found.find(time_ns);
    const std::string& status = statuses.at(time_ns);
    const bool is_claimed = status == "detected" || status == "tracked";
    EXPECT_TRUE(estimate != found.end() || !is_claimed) << time_ns;
    if (estimate == found.end()) continue;
    const double error_px = corner_error_px(pose, estimate->second);
    ++counts.with_pose;
    counts.claimed += is_claimed ? 1 : 0;
    counts.silent_failures += is_claimed && error_px > 10.0 ? 1 : 0;
    counts.within_5px += error_px < 5.0 ? 1 : 0;
  }
  return counts;
}

std::string percent(int count, int all) {
  return fmt::format("{:.0f} %", 100.0 * count / all);
}

/// The cells of the scene's rows under `head`, by method.
std::map<std::string, std::string> column_of_single(const json& summary, const std::string& head) {
  const auto& header = summary["header"];
  const auto column =
      static_cast<std::size_t>(std::find(header.begin(), header.end(), head) - header.begin());
  std::map<std::string, std::string> cells;
  EXPECT_LT(column, header.size()) << head;
  for (const json& row : summary["rows"]) {
    if (row[0] == "single" && column < row.size()) cells[row[1]] = row[column];
  }
  return cells;
}

/// Under `blur ...`: every frame and every pose is counted once, and a median is one of five poses or more.
void expect_counts_by_blur(const json& summary, const std::string& method, const Counts& counts) {
  int poses_told = 0, frames_told = 0;
  for (const char* head : {"blur < 5 px", "blur 5-20 px", "blur > 20 px"}) {
    const std::string cell = column_of_single(summary, head)[method];
    const std::size_t bracket = cell.find('('), slash = cell.find('/', bracket);
    ASSERT_NE(slash, std::string::npos) << cell;
    const int poses = std::stoi(cell.substr(bracket + 1)), frames = std::stoi(cell.substr(slash + 1));
    EXPECT_EQ(cell.front() == '-', poses < 5) << cell;
    poses_told += poses;
    frames_told += frames;
  }
  EXPECT_EQ(poses_told, counts.with_pose) << method;
  EXPECT_EQ(frames_told, counts.frames) << method;
}

void expect_plain_arithmetic(const fs::path& demo, const json& summary) {
  const std::string camera = read_text(demo / "single" / "camera.yaml");
  for (const char* line :
       {"intrinsics: [1000, 1000, 639.5, 359.5]", "distortion_model: none", "resolution: [1280, 720]"})
    ASSERT_NE(camera.find(line), std::string::npos) << line;
  const std::string map = read_text(demo / "single" / "map.yaml");
  ASSERT_EQ(count_of("- id:", map), 1U);
  for (const char* line :
       {"size: 0.16\n", "position: {x: 0, y: 0, z: 0}", "orientation: {x: 0, y: 0, z: 0, w: 1}"})
    ASSERT_NE(map.find(line), std::string::npos) << line;
  auto claimed = column_of_single(summary, "claimed"),
       wrong = column_of_single(summary, "claimed, over 10 px"),
       good = column_of_single(summary, "within 5 px");
  ASSERT_EQ(claimed.size(), 3U);
  int num_unclaimed = 0, num_silent = 0;
  for (const std::string method : {"pnp", "paper", "blur"}) {
    const Counts counts = count_single(demo, method);
    ASSERT_EQ(counts.frames, 14);
    ASSERT_GT(counts.claimed, 0);
    EXPECT_EQ(claimed[method], percent(counts.claimed, counts.frames)) << method;
    EXPECT_EQ(wrong[method], percent(counts.silent_failures, counts.claimed)) << method;
    EXPECT_EQ(good[method], percent(counts.within_5px, counts.frames)) << method;
    expect_counts_by_blur(summary, method, counts);
    num_unclaimed += counts.frames - counts.claimed;
    num_silent += counts.silent_failures;
  }
  EXPECT_GT(num_unclaimed, 0) << "no test of the claims";
  EXPECT_GT(num_silent, 0) << "no test of the silent failures";
}

TEST(Demo, TellsWhatEvaluateTellsAndShowsItOnOnePage) {
  const fs::path folder = temporary_folder() / "demo";
  const json summary = run_for_json({"demo", "--frames", "28", "--output", folder});
  ASSERT_EQ(summary["rows"].size(), 9U);
  for (const json& row : summary["rows"]) {
    ASSERT_EQ(row.size(), summary["header"].size());
    const std::string scene = row[0], method = row[1];
    const json score =
        run_for_json({"evaluate", "--truth", folder / scene, "--mode", scene == "room" ? "ego" : "joint",
                      "--estimate", folder / fmt::format("{}_{}.tum", scene, method), "--frames-csv",
                      folder / fmt::format("{}_{}_frames.csv", scene, method)});
    EXPECT_EQ(row[3], fmt::format("{:.0f} %", 100.0 * score["success_5px"].get<double>())) << row;
  }

  expect_plain_arithmetic(folder, summary);

  const std::string page = read_text(summary["report"].get<std::string>());
  EXPECT_EQ(count_of("data:video/mp4;base64,", page), 3U);
  EXPECT_EQ(count_of("data:image/png;base64,", page), 9U);
  EXPECT_EQ(count_of("<table", page), 1U);
  EXPECT_EQ(count_of(" --seed 1 --frames 28 --threads 0", page), 1U);
  EXPECT_EQ(count_of("src=\"http", page), 0U) << "the page needs a network";
  EXPECT_EQ(decode_video(folder / "room_blur.mp4").frames.size(), 28U);
  EXPECT_EQ(decode_video(folder / "bundle_blur.mp4").frames.size(), 14U);
}

}  // namespace
}  // namespace apriltrack::test
