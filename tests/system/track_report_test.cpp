// `track --report`: the page's figures are those of the frame log, counted here anew; it is there, too, where
// no pose is.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>

#include "log_lines.h"
#include "one_image.h"
#include "program.h"
#include "read_report.h"
#include "tracked_film.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

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
  EXPECT_NEAR(latency[4], time_s_of(slowest(log)) - time_s_of(log.front()), 0.00051);
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

}  // namespace
}  // namespace apriltrack::test
