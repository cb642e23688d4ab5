// `track --report`: the page's figures are those of the frame log, counted here anew; it is there, too, where
// no pose is.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <sstream>

#include "filmed_wall.h"
#include "one_image.h"
#include "program.h"
#include "read_report.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

using LogLine = std::map<std::string, std::string>;

/// The frame log, read without the library.
std::vector<LogLine> read_log(const fs::path& path) {
  std::istringstream lines(read_text(path));
  std::vector<std::string> names;
  std::vector<LogLine> log;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::vector<std::string> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(cell);
    if (names.empty()) {
      names = values;
      continue;
    }
    values.resize(names.size());
    log.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i) log.back()[names[i]] = values[i];
  }
  return log;
}

std::vector<double> column(const std::vector<LogLine>& log, const std::string& name,
                           const std::string& status = "") {
  std::vector<double> values;
  for (const LogLine& line : log)
    if (!line.at(name).empty() && (status.empty() || line.at("status") == status))
      values.push_back(std::stod(line.at(name)));
  return values;
}

/// Of the sorted values, the one at that fraction of the way, linearly between ranks.
double quantile(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  const double rank = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

double time_of(const LogLine& line) {
  return 1e-9 * static_cast<double>(std::stoll(line.at("timestamp_ns")));
}

const LogLine& slowest(const std::vector<LogLine>& log) {
  const auto latency_ms = [](const LogLine& line) {
    return line.at("latency_ms").empty() ? -1.0 : std::stod(line.at("latency_ms"));
  };
  return *std::ranges::max_element(log, {}, latency_ms);
}

/// Longest time between frames with evidence, or to the recording's ends, in which frames have none.
double longest_gap_s(const std::vector<LogLine>& log) {
  const auto time_s = [&](std::size_t i) {
    return 1e-9 *
           static_cast<double>(std::stoll(log[i].at("timestamp_ns")) - std::stoll(log[0].at("timestamp_ns")));
  };
  double longest = 0.0, since = 0.0;
  bool is_blind = false;
  for (std::size_t i = 0; i < log.size(); ++i) {
    const std::string& status = log[i].at("status");
    const bool has_evidence = status == "detected" || status == "tracked";
    if ((has_evidence && is_blind) || (!has_evidence && i + 1 == log.size()))
      longest = std::max(longest, time_s(i) - since);
    if (has_evidence) since = time_s(i);
    is_blind = !has_evidence;
  }
  return longest;
}

/// A shaken camera in a room: some frames are too blurred for detection; the fourth is no picture.
class TrackReport : public ::testing::Test {
 protected:
  /// Filmed and tracked once for all tests, by the first one that runs.
  void SetUp() override {
    if (!folder_.empty()) return;
    folder_ = temporary_folder();
    run_for_json({"simulate", "--scene", "room", "--frames", "14", "--speed", "3", "--output", path("film")});
    std::vector<fs::path> pictures;
    for (const auto& entry : fs::directory_iterator(path("film/frames"))) pictures.push_back(entry.path());
    std::ranges::sort(pictures, {}, [](const fs::path& picture) { return std::stoll(picture.stem()); });
    std::ofstream(pictures.at(3), std::ios::trunc) << "no picture";
    run_ = run_program({"track", path("film"), "--method", "pnp", "--output", path("out.tum"), "--frames-csv",
                        path("frames.csv"), "--report", path("it's.html")});
  }
  static fs::path path(const std::string& name) { return folder_ / name; }

  static inline fs::path folder_;
  static inline ProgramRun run_;
};

TEST_F(TrackReport, CountsWhatTheFrameLogSays) {
  ASSERT_EQ(run_.status, 0) << run_.err;
  EXPECT_THAT(run_.out, HasSubstr("report: " + path("it's.html").string()));
  const ReadReport page(path("it's.html"));
  const std::vector<LogLine> log = read_log(path("frames.csv"));
  ASSERT_EQ(log.size(), 14U);
  std::size_t lost = 0;
  for (const char* status : {"detected", "tracked", "predicted", "lost", "unreadable"}) {
    const auto frames = static_cast<double>(
        std::ranges::count_if(log, [&](const LogLine& line) { return line.at("status") == status; }));
    const std::vector<std::string> cells = page.row(status);
    ASSERT_EQ(cells.size(), 6U) << status;
    EXPECT_THAT(numbers_in(cells[0]), ElementsAre(frames)) << status;
    EXPECT_NEAR(numbers_in(cells[1])[0], 100.0 * frames / 14.0, 0.051) << status;
    if (std::string(status) == "lost") lost = static_cast<std::size_t>(frames);
  }
  EXPECT_EQ(page.row("unreadable")[0], "1");
  EXPECT_GE(lost, 1U) << "the film must be too fast for some frames";
  EXPECT_LE(lost, 10U);
  EXPECT_THAT(page.texts("p"), Contains(HasSubstr(fmt::format("{} of 14 frames", 13 - lost))));
  EXPECT_NEAR(numbers_in(page.row("longest stretch without evidence")[0])[0], longest_gap_s(log), 0.00051);
}

TEST_F(TrackReport, TellsTheClaimsAndLatenciesOfTheFrameLog) {
  const ReadReport page(path("it's.html"));
  const std::vector<LogLine> log = read_log(path("frames.csv"));
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const std::vector<double> sigma_m = column(log, "sigma_position_m"),
                            sigma_rad = column(log, "sigma_rotation_rad");
  ASSERT_GE(sigma_m.size(), 3U);
  const auto claims = numbers_in(page.row("claimed error (sigma), median of all poses")[0]);
  ASSERT_EQ(claims.size(), 4U);
  EXPECT_NEAR(claims[0], 1e3 * quantile(sigma_m, 0.5), 0.0051);
  EXPECT_NEAR(claims[1], kDegrees * quantile(sigma_rad, 0.5), 0.00051);
  EXPECT_NEAR(claims[2], 1e3 * quantile(sigma_m, 1.0), 0.0051);
  EXPECT_NEAR(claims[3], kDegrees * quantile(sigma_rad, 1.0), 0.00051);
  const auto from_one_tag = std::ranges::count_if(
      log, [](const LogLine& line) { return !line.at("tx").empty() && line.at("tags_tracked") == "1"; });
  EXPECT_EQ(numbers_in(page.row("poses from a single tag")[0])[0], static_cast<double>(from_one_tag));
  const auto latency = numbers_in(page.row("latency")[0]);
  ASSERT_EQ(latency.size(), 5U) << "one of them the 99 %";
  EXPECT_NEAR(latency[0], quantile(column(log, "latency_ms"), 0.5), 0.051);
  EXPECT_NEAR(latency[1], quantile(column(log, "latency_ms"), 0.99), 0.051);
  EXPECT_NEAR(latency[3], quantile(column(log, "latency_ms"), 1.0), 0.051);
  EXPECT_NEAR(latency[4], time_of(slowest(log)) - time_of(log.front()), 0.00051);
}

TEST_F(TrackReport, NamesTheSlowestFrameOnTheTerminalToo) {
  const LogLine slow = slowest(read_log(path("frames.csv")));
  EXPECT_THAT(run_.out, HasSubstr(fmt::format(" ms (max, at {} ns)", slow.at("timestamp_ns"))));
}

TEST_F(TrackReport, NamesTheSlowestFrameForMachinesToo) {
  const nlohmann::json told = run_for_json({"track", path("film"), "--method", "pnp", "--output",
                                            path("json.tum"), "--frames-csv", path("json.csv")});
  const LogLine slow = slowest(read_log(path("json.csv")));
  EXPECT_EQ(told["latency_max_timestamp_ns"], std::stoll(slow.at("timestamp_ns")));
  EXPECT_NEAR(told["latency_max_ms"], std::stod(slow.at("latency_ms")), 0.00051);
}

TEST_F(TrackReport, NeedsNothingBesideItself) {
  const ReadReport page(path("it's.html"));
  for (const char* reference :
       {"http:", "https:", "//", "href", "<link", "@import", "url(", "<iframe", "src="})
    EXPECT_THAT(page.source(), Not(HasSubstr(reference))) << reference;
  EXPECT_EQ(page.texts("svg").size(), 13U)
      << "statuses, 3 errors, path from above and two sides, position, rotation, 2 sigmas, tags, latency";
  EXPECT_EQ(page.texts("canvas").size(), 1U);
}

TEST_F(TrackReport, SaysHowItWasMadeAndWhatTheTerminalWarnedOf) {
  const ReadReport page(path("it's.html"));
  EXPECT_THAT(page.texts("code"),
              ElementsAre(fmt::format("apriltrack track {} --method pnp --output {} --frames-csv {} --report "
                                      "'{}'",
                                      path("film").string(), path("out.tum").string(),
                                      path("frames.csv").string(), path("it'\\\\''s.html").string())));
  const std::string warning = "1 of 14 frames are left out";
  EXPECT_THAT(run_.err, HasSubstr(warning));
  EXPECT_THAT(page.texts("p").front(), HasSubstr(warning)) << "before all else";
  EXPECT_THAT(page.row("map")[0], HasSubstr("14 tags"));
  EXPECT_THAT(page.row("mode")[0], HasSubstr("T_world_camera"));
}

/// Median distance from the true positions, of the poses of a run, by their exact time stamps.
double median_error_mm(const fs::path& truth, const fs::path& estimate) {
  const auto positions = [](const fs::path& file) {
    std::map<std::string, Eigen::Vector3d> at;
    std::istringstream lines(read_text(file));
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string time;
      Eigen::Vector3d p;
      if (!line.empty() && line[0] != '#' && words >> time >> p.x() >> p.y() >> p.z()) at[time] = p;
    }
    return at;
  };
  const auto true_at = positions(truth);
  std::vector<double> errors_mm;
  for (const auto& [time, p] : positions(estimate))
    if (true_at.contains(time)) errors_mm.push_back(1e3 * (p - true_at.at(time)).norm());
  return quantile(errors_mm, 0.5);
}

TEST_F(TrackReport, MeasuresAgainstTheTruthWhereThereIsOne) {
  const ReadReport page(path("it's.html"));
  EXPECT_THAT(page.texts("h2"), Contains("Against the truth"));
  EXPECT_THAT(page.row("frames whose truth shows a tag"), ElementsAre("14"));
  EXPECT_NEAR(numbers_in(page.row("position error, median")[0])[0],
              median_error_mm(path("film/truth.tum"), path("out.tum")), 0.0051);

  fs::copy(path("film"), path("untold"), fs::copy_options::recursive);
  fs::remove(path("untold/truth.tum"));
  run_for_json({"track", path("untold"), "--method", "pnp", "--output", path("o.tum"), "--report",
                path("untold.html")});
  const ReadReport untold(path("untold.html"));
  EXPECT_THAT(untold.texts("h2"), Not(Contains("Against the truth")));
  EXPECT_THAT(untold.source(), Not(HasSubstr("truth.tum")));
}

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

TEST_F(TrackReport, ReplacesNothingOfOthersAndIsCheckedBeforeTheWork) {
  const auto track_to = [&](const fs::path& report) {
    return run_program(
        {"track", path("film"), "--method", "pnp", "--output", path("no.tum"), "--report", report});
  };
  EXPECT_THAT(track_to(path("nowhere/report.html")), EndsWith(3, "nowhere"));
  EXPECT_THAT(track_to(path("film/truth.tum")), EndsWith(2, "is a recording's own file"));
  EXPECT_THAT(track_to(path("film/map.yaml")), EndsWith(2, "--report"));
  EXPECT_THAT(track_to(path("no.tum")), EndsWith(2, "is the file of --output"));
  EXPECT_FALSE(fs::exists(path("no.tum")));
}

TEST_F(TrackReport, IsOfBodiesAndOfASingleFrameToo) {
  run_for_json({"simulate", "--scene", "bundle", "--frames", "1", "--speed", "0.2", "--exposure", "0.001",
                "--output", path("body")});
  for (const char* method : {"pnp", "paper", "blur"}) {
    const auto summary = run_for_json({"track", path("body"), "--mode", "joint", "--method", method,
                                       "--output", path("body.tum"), "--report", path("body.html")});
    EXPECT_EQ(summary["report"], path("body.html").string()) << method;
    const ReadReport page(path("body.html"));
    EXPECT_THAT(page.texts("h2"), Contains("Where the body was")) << method;
    EXPECT_THAT(page.row("mode")[0], HasSubstr("T_camera_body"));
    EXPECT_THAT(page.row("method")[0], HasSubstr(method));
    EXPECT_EQ(page.has_row("particles"), std::string(method) != "pnp");
    EXPECT_THAT(page.row("frames")[0], HasSubstr("1 in 0.000 s"));
  }
}

using TrackReportOfNothing = OneImage;

TEST_F(TrackReportOfNothing, SaysWhy) {
  EXPECT_THAT(track({"--report", path("report.html")}), EndsWith(1, "no tag of family"));
  EXPECT_FALSE(std::filesystem::exists(path("out.tum")));
  const ReadReport page(path("report.html"));
  EXPECT_THAT(page.texts("p"), Contains(HasSubstr("No frame has a pose: no tag of family")));
  EXPECT_THAT(page.row("lost")[0], "1");
  EXPECT_THAT(page.row("first pose"), ElementsAre("none"));
  EXPECT_THAT(page.texts("h2"), Not(Contains("Where the camera was")));
}

/// Corners of the wall's tags 0 to 2, in place of images.
class TrackReportOfCorners : public ::testing::Test {
 protected:
  /// tags_of: the tags that are seen in a frame; number 10 is not in the map.
  ReadReport track(int num_frames, std::int64_t interval_ns,
                   const std::function<std::vector<int>(int)>& tags_of, const std::string& of_each_tag = "") {
    {
      std::ofstream rows(folder_ / "corners.csv");
      rows << kDetectionsHeader;
      for (int i = 0; i < num_frames; ++i)
        for (const int id : tags_of(i))
          rows << wall_row(1'000'000'000LL + interval_ns * i, camera_from_wall(i % 7), id);
    }
    write_text(folder_ / "camera.yaml", pinhole_entry("cam0"));
    std::string map = "apriltrack_map: 1\nframe: wall\ndefault_family: tag36h11\ntags:\n";
    for (const int id : {0, 1, 2})
      map += fmt::format(
          "  - id: {}\n    size: 0.16\n    pose:\n      position: {{x: {}, y: {}, z: {}}}\n      "
          "orientation: {{x: 0.0, y: 0.0, z: 0.0, w: 1.0}}\n{}",
          id, kWallPlaces_m.at(id).x(), kWallPlaces_m.at(id).y(), kWallPlaces_m.at(id).z(), of_each_tag);
    write_text(folder_ / "map.yaml", map);
    run_for_json({"track", "--detections", folder_ / "corners.csv", "--camera", folder_ / "camera.yaml",
                  "--map", folder_ / "map.yaml", "--output", folder_ / "out.tum", "--report",
                  folder_ / "report.html"});
    return ReadReport(folder_ / "report.html");
  }

  const fs::path folder_ = temporary_folder();
};

TEST_F(TrackReportOfCorners, TellsWhereTheEvidenceIsMissing) {
  // Nothing of the map in frames 0, 3 to 7, and 18 and 19, ten a second.
  const ReadReport page = track(20, 100'000'000, [](int i) {
    const bool is_blind = i == 0 || (i >= 3 && i <= 7) || i >= 18;
    return is_blind ? std::vector<int>{10} : std::vector<int>{0, 1, 2};
  });
  EXPECT_THAT(page.row("longest stretch without evidence"),
              ElementsAre("0.600 s (5 frames), from 0.200 s to 0.800 s"));
  EXPECT_THAT(page.row("first pose"), ElementsAre("at 0.100 s"));
  const std::string reason = "no tag of the map seen";
  EXPECT_THAT(page.row("0.200"), ElementsAre("0.600", "5 lost", "1300000000", reason));
  EXPECT_THAT(page.row("1.700"), ElementsAre("0.200", "2 lost", "2800000000", reason));
  EXPECT_THAT(page.row("0.000"), ElementsAre("0.100", "1 lost", "1000000000", reason));
  EXPECT_THAT(page.row(reason), ElementsAre("8"));
  EXPECT_THAT(page.texts("p"), Contains(HasSubstr("not in the map, and so of no use: tag36h11/10.")));
}

/// A tag's covariance: sigma_m along each axis, and next to nothing for its orientation.
std::string covariance_entry(double sigma_m) {
  std::string text = "    covariance: [";
  for (int i = 0; i < 36; ++i) {
    const double number = i % 7 != 0 ? 0.0 : i < 18 ? sigma_m * sigma_m : 1e-12;
    text += fmt::format("{}{}", i == 0 ? "" : ", ", number);
  }
  return text + "]\n";
}

TEST_F(TrackReportOfCorners, TellsOfTheMapsPartInTheClaimedError) {
  const std::string words = "The map's own uncertainty";
  const auto all_tags = [](int) { return std::vector<int>{0, 1, 2}; };
  const ReadReport vague = track(6, 100'000'000, all_tags, covariance_entry(0.01));
  EXPECT_THAT(vague.texts("p"), Contains(AllOf(HasSubstr(words), HasSubstr("17.32 mm"))));  // 10 mm x root 3
  EXPECT_GT(numbers_in(vague.row("claimed error (sigma), median of all poses")[0])[0], 5.0);
  const ReadReport sure = track(6, 100'000'000, all_tags, covariance_entry(1e-7));
  EXPECT_THAT(sure.texts("p"), Not(Contains(HasSubstr(words))));
  const ReadReport untold = track(6, 100'000'000, all_tags);
  EXPECT_THAT(untold.texts("p"), Not(Contains(HasSubstr(words))));
}

TEST_F(TrackReportOfCorners, OfTenThousandFramesIsNoLargerThanItsPictures) {
  const ReadReport page = track(10'000, 33'333'333, [](int i) {
    return i % 3 == 0 ? std::vector<int>{0} : std::vector<int>{0, 1, 2};
  });
  EXPECT_THAT(page.row("detected")[0], "10000");
  EXPECT_THAT(page.row("input")[0], HasSubstr("corners.csv"));
  EXPECT_LT(fs::file_size(folder_ / "report.html"), 4'000'000U);
}

}  // namespace
}  // namespace apriltrack::test
