// The blur tracker through the command line: what it follows, and what it refuses.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "apriltrack/eval/trajectory.h"
#include "apriltrack/tags/tag_map.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

struct Shown {
  const char* scene;
  const char* mode;
  const char* exposure_s;
  double min_blur_px;  // of the most blurred frame
};

/// A short film that begins readable, and whose blur then hides tags.
class TrackBlur : public ::testing::TestWithParam<Shown> {
 protected:
  TrackBlur() {
    told_ = run_for_json({"simulate", "--scene", GetParam().scene, "--frames", "14", "--speed", "1.5",
                          "--exposure", GetParam().exposure_s, "--seed", "5", "--output", film_});
  }

  const fs::path folder_ = temporary_folder();
  const std::string film_ = folder_ / "film";
  json told_;
};

INSTANTIATE_TEST_SUITE_P(Scenes, TrackBlur,
                         ::testing::Values(Shown{"room", "ego", "0.025", 15.0},
                                           Shown{"single", "joint", "0.02", 30.0}),
                         [](const auto& shown) { return std::string(shown.param.scene); });

TEST_P(TrackBlur, IsTheDefaultAndRepeatsItselfOnAnyNumberOfThreads) {
  ASSERT_GE(told_["max_blur_px"].get<double>(), GetParam().min_blur_px);
  ASSERT_GE(told_["share_over_10_px"].get<double>(), 0.4);
  std::set<std::string> texts;
  for (const std::string threads : {"1", "2", "2"}) {
    const fs::path tum = folder_ / "out.tum";
    const json summary = run_for_json({"track", film_, "--mode", GetParam().mode, "--seed", "7", "--threads",
                                       threads, "--output", tum, "--frames-csv", folder_ / "out.csv"});
    EXPECT_EQ(summary["method"], "blur");
    EXPECT_EQ(summary["lost"], 0);
    EXPECT_GE(summary["tracked"].get<int>(), 2) << "every frame could be read";
    texts.insert(read_text(tum));
  }
  EXPECT_EQ(texts.size(), 1U);
  const json score = run_for_json({"evaluate", "--truth", film_, "--mode", GetParam().mode, "--estimate",
                                   folder_ / "out.tum", "--frames-csv", folder_ / "out.csv"});
  EXPECT_EQ(score["coverage"], 1.0);
  EXPECT_GE(score["success_5px"].get<double>(), 0.92) << score.dump(1);
  EXPECT_LE(score["median_px"].get<double>(), 0.3) << score.dump(1);
}

class TrackBlurErrors : public ::testing::Test {
 protected:
  TrackBlurErrors() { run_for_json({"simulate", "--scene", "room", "--frames", "4", "--output", film_}); }

  std::vector<std::string> track(std::vector<std::string> more) const {
    more.insert(more.begin(), {"track", film_, "--output", folder_ / "out.tum"});
    return more;
  }

  /// The film's camera with another line in the place of the one that begins with `key`.
  std::string camera_with(const std::string& key, const std::string& line) const {
    std::istringstream text(read_text(fs::path(film_) / "camera.yaml"));
    const fs::path path = folder_ / "camera.yaml";
    std::ofstream out(path);
    int num_changed = 0;
    for (std::string old; std::getline(text, old);) {
      const bool is_it = old.find(key + ":") != std::string::npos;
      if (!is_it) out << old << '\n';
      if (is_it && !line.empty()) out << "  " << line << '\n';
      num_changed += is_it ? 1 : 0;
    }
    EXPECT_EQ(num_changed, 1) << key;
    return path;
  }

  const fs::path folder_ = temporary_folder();
  const std::string film_ = folder_ / "film";
};

TEST_F(TrackBlurErrors, AnExposureThatCannotBeIsStatus2) {
  EXPECT_THAT(run_program(track({"--camera", camera_with("exposure_time", "exposure_time: 0")})),
              EndsWith(2, "exposure_time"));
  const ProgramRun run =
      run_program(track({"--camera", camera_with("exposure_time", "exposure_time: 0.05")}));
  EXPECT_THAT(
      run,
      EndsWith(2, (folder_ / "camera.yaml").string() +
                      ": cam0.exposure_time: 0.05 s is longer than the 0.033333 s since the frame before"));
  EXPECT_FALSE(fs::exists(folder_ / "out.tum"));
}

// Too long from the third frame on: one wrong time stamp may look like that, so the run goes on.
TEST_F(TrackBlurErrors, ALaterExposureThatCannotBeIsWarnedOfOnce) {
  std::ofstream table(fs::path(film_) / "frames.csv");
  table << "timestamp_ns,exposure_s,gain\n";
  int num_frames = 0;
  for (const TimedPose& frame : read_tum(fs::path(film_) / "truth.tum"))
    table << frame.timestamp.ns << (num_frames++ < 2 ? ",0.004,1\n" : ",0.4,1\n");
  table.close();
  const json summary = run_for_json(track({"--method", "pnp"}));
  ASSERT_EQ(summary["warnings"].size(), 1U) << summary.dump(1);
  EXPECT_EQ(summary["warnings"][0].get<std::string>().find(film_ +
                                                           "/frames.csv:4: exposure_s: 0.4 s is longer than"),
            0U);
}

TEST_F(TrackBlurErrors, AnExposureOfAFrameThatCannotBeIsStatus2WithItsLine) {
  const Trajectory truth = read_tum(fs::path(film_) / "truth.tum");
  const auto track_with = [&](const char* exposure) {
    std::ofstream table(fs::path(film_) / "frames.csv");
    table << "timestamp_ns,exposure_s\n";
    for (const TimedPose& frame : truth) table << frame.timestamp.ns << ',' << exposure << '\n';
    table.close();
    return run_program(track({"--method", "pnp"}));
  };
  EXPECT_THAT(track_with("0.05"), EndsWith(2, film_ + "/frames.csv:3: exposure_s: 0.05 s is longer than the "
                                                      "0.033333 s since the frame before"));
  EXPECT_THAT(track_with("1e-9"), EndsWith(2, film_ + "/frames.csv:2: exposure_s: must lie in [1e-07, 1] "
                                                      "seconds (is 1e-09)"));
  EXPECT_THAT(run_program({"simulate", "--scene", "single", "--exposure", "1e-9", "--output", folder_ / "s"}),
              EndsWith(2, "--exposure: must lie in [1e-07, 1] seconds (is 1e-09)"));
}

TEST_F(TrackBlurErrors, AFramesCsvThatKnowsNotAllFramesIsToldOf) {
  const Trajectory truth = read_tum(fs::path(film_) / "truth.tum");
  const std::string file = film_ + "/frames.csv";
  const std::int64_t first_ns = truth.front().timestamp.ns, last_ns = truth.back().timestamp.ns;
  write_text(file, fmt::format("timestamp_ns,exposure_s\n{},0.004\n{},0.004\n", first_ns, first_ns + 1));
  const json summary = run_for_json(track({"--method", "pnp"}));
  ASSERT_EQ(summary["warnings"].size(), 1U) << summary.dump(1);
  EXPECT_EQ(summary["warnings"][0].get<std::string>().find(file + ": 3 of 4 frames have no row in it"), 0U);
  write_text(file, fmt::format("timestamp_ns,exposure_s\n{},0.004\n", first_ns + 1));
  EXPECT_THAT(
      run_program(track({"--method", "pnp"})),
      EndsWith(2, fmt::format("{}: none of its rows has the time of a frame: its timestamp_ns run from "
                              "{} to {}, the frames from {} to {}",
                              file, first_ns + 1, first_ns + 1, first_ns, last_ns)));
}

TEST_F(TrackBlurErrors, AnExposureThatNobodyTellsIsWarnedOf) {
  fs::remove(fs::path(film_) / "frames.csv");
  const std::string warning = "no exposure is known: 0.01 s is assumed";
  const ProgramRun run = run_program(track({"--camera", camera_with("exposure_time", ""), "--json"}));
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.err.find(warning), std::string::npos) << run.err;
  EXPECT_NE(json::parse(run.out)["warnings"].dump().find(warning), std::string::npos) << run.out;
}

TEST_F(TrackBlurErrors, ASizeOfAnotherCameraIsStatus2) {
  const ProgramRun run =
      run_program(track({"--camera", camera_with("resolution", "resolution: [320, 240]")}));
  EXPECT_THAT(run, EndsWith(2, "640"));
  EXPECT_NE(run.err.find("320"), std::string::npos) << run.err;
}

TEST_F(TrackBlurErrors, NoMappedTagEverSeenIsStatus1WithTheTagsOfBoth) {
  TagMap map = read_tag_map(fs::path(film_) / "map.yaml");
  for (MapTag& tag : map.tags) tag.key.id += 100;
  write_tag_map(folder_ / "other.yaml", map);
  const ProgramRun run = run_program(track({"--map", folder_ / "other.yaml"}));
  EXPECT_THAT(run, EndsWith(1, "no tag of the map"));
  EXPECT_NE(run.err.find("give the map of this place"), std::string::npos) << run.err;
}

TEST_F(TrackBlurErrors, AWrongFamilyIsToldApartFromAnUnknownOne) {
  TagMap map = read_tag_map(fs::path(film_) / "map.yaml");
  for (MapTag& tag : map.tags) tag.key.family = "tag25h9";
  write_tag_map(folder_ / "other.yaml", map);
  EXPECT_THAT(run_program(track({"--map", folder_ / "other.yaml"})), EndsWith(1, "family"));
  std::ofstream(folder_ / "unknown.yaml")
      << "apriltrack_map: 1\nframe: world\ndefault_family: tag99h1\ntags:\n  - id: 0\n    size: 0.16\n    "
         "pose:\n"
         "      position: {x: 0, y: 0, z: 0}\n      orientation: {x: 0, y: 0, z: 0, w: 1}\n";
  EXPECT_THAT(run_program(track({"--map", folder_ / "unknown.yaml"})), EndsWith(2, "tag99h1"));
}

TEST_F(TrackBlurErrors, CornersAloneAreForPnp) {
  EXPECT_THAT(run_program({"track", "--detections", folder_ / "corners.csv", "--method", "blur", "--output",
                           folder_ / "o.tum"}),
              EndsWith(2, "--method pnp"));
  EXPECT_THAT(run_program(track({"--particles", "3"})), EndsWith(2, "--particles: must be at least 16"));
}

}  // namespace
}  // namespace apriltrack::test
