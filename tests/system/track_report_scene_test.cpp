// `track --report`: the scene and the table of tags hold what the files of the same run hold.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "log_lines.h"
#include "program.h"
#include "read_report.h"
#include "tracked_film.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

/// Numbers of a trajectory file but the times.
std::vector<std::vector<double>> poses_in(const fs::path& file) {
  std::vector<std::vector<double>> poses;
  std::istringstream lines(read_text(file));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string time;
    words >> time;
    poses.emplace_back();
    for (double number = 0.0; words >> number;) poses.back().push_back(number);
  }
  return poses;
}

/// Those of a path of a scene that are there.
std::vector<std::vector<double>> poses_in(const nlohmann::json& path) {
  std::vector<std::vector<double>> poses;
  for (std::size_t i = 0; i < path["time_s"].size(); ++i) {
    if (path["position_m"][3 * i].is_null()) continue;
    poses.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) poses.back().push_back(path["position_m"][3 * i + k]);
    for (std::size_t k = 0; k < 4; ++k) poses.back().push_back(path["orientation_xyzw"][4 * i + k]);
  }
  return poses;
}

void expect_same_poses(const std::vector<std::vector<double>>& shown,
                       const std::vector<std::vector<double>>& filed) {
  ASSERT_EQ(shown.size(), filed.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    ASSERT_EQ(shown[i].size(), filed[i].size());
    for (std::size_t k = 0; k < shown[i].size(); ++k) EXPECT_NEAR(shown[i][k], filed[i][k], 0.6e-5) << i;
  }
}

TEST_F(TrackReport, ShowsThePosesAndTheTruthOfTheFiles) {
  const ReadReport page(path("it's.html"));
  const nlohmann::json scene = nlohmann::json::parse(page.texts("script").at(0));
  EXPECT_EQ(scene["moving"], "camera");
  EXPECT_EQ(scene["tags"].size(), 14U);
  expect_same_poses(poses_in(scene["path"]), poses_in(path("out.tum")));
  expect_same_poses(poses_in(scene["true_path"]), poses_in(path("film/truth.tum")));
  const std::vector<LogLine> log = read_log(path("frames.csv"));
  ASSERT_EQ(scene["path"]["state"].size(), log.size());
  for (std::size_t i = 0; i < log.size(); ++i)
    EXPECT_EQ(scene["path_states"][scene["path"]["state"][i].get<std::size_t>()]["name"], log[i].at("status"))
        << i;
}

/// The table of tags against the log of the same run, counted anew.
TEST_F(TrackReport, CountsWhatTheTagLogSays) {
  run_for_json({"track", path("film"), "--method", "blur", "--output", path("tags.tum"), "--tags-csv",
                path("tags.csv"), "--report", path("tags.html")});
  const ReadReport page(path("tags.html"));
  const std::vector<LogLine> log = read_log(path("tags.csv"));
  ASSERT_FALSE(log.empty());
  const nlohmann::json map = run_for_json({"map", "show", path("film/map.yaml")});
  std::size_t counted = 0;
  for (const auto& tag : map["tags"]) {
    const std::string id = fmt::format("{}", tag["id"].get<int>());
    const std::vector<std::string> cells = page.row("tag36h11/" + id);
    ASSERT_EQ(cells.size(), 9U);
    const auto frames = [&](const std::string& status) {
      return std::ranges::count_if(
          log, [&](const LogLine& line) { return line.at("id") == id && line.at("status") == status; });
    };
    const char* statuses[] = {"detected", "tracked", "occluded", "hidden"};
    for (std::size_t i = 0; i < std::size(statuses); ++i) {
      const auto count = frames(statuses[i]);
      EXPECT_EQ(cells[i], count == 0 ? "-" : fmt::format("{}", count)) << id << " " << statuses[i];
      counted += static_cast<std::size_t>(count);
    }
    std::vector<double> residuals_px;
    for (const LogLine& line : log)
      if (line.at("id") == id && !line.at("residual_px").empty())
        residuals_px.push_back(std::stod(line.at("residual_px")));
    if (residuals_px.empty()) {
      EXPECT_EQ(cells[6], "-") << id;
    } else {
      EXPECT_NEAR(numbers_in(cells[6]).at(0), quantile(residuals_px, 0.5), 0.0051) << id;
    }
  }
  EXPECT_GT(counted, 10U);
}

TEST_F(TrackReport, NumbersTheTagsOfThePath) {
  const std::vector<std::string> words = ReadReport(path("it's.html")).texts("text");
  const nlohmann::json map = run_for_json({"map", "show", path("film/map.yaml")});
  for (const auto& tag : map["tags"])
    EXPECT_EQ(std::ranges::count(words, fmt::format("{}", tag["id"].get<int>())) >= 3, true) << tag["id"];
}

}  // namespace
}  // namespace apriltrack::test
