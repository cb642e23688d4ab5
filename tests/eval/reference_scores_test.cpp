// Digit by digit against the independent scorers (score_track.py, score_map.py) on disturbed estimates of
// recordings.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdio.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apriltrack/camera/camera.h"
#include "apriltrack/eval/compare_maps.h"
#include "apriltrack/eval/evaluate_frame_log.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "apriltrack/eval/statistics.h"
#include "eval/synthetic.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

struct CommandResult {
  int status = -1;
  std::string output;
};

CommandResult run(const std::string& command) {
  CommandResult result;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (!pipe) return result;
  char block[4096];
  while (const std::size_t count = ::fread(block, 1, sizeof block, pipe)) result.output.append(block, count);
  result.status = ::pclose(pipe);
  return result;
}

const std::string kModules = "numpy, yaml";  // of the scorers

json run_scorer(const std::string& command) {
  const CommandResult result = run(command);
  EXPECT_EQ(result.status, 0) << command;
  // Python prints NaN, which is no JSON, where a bin has no pose.
  std::string text = result.output;
  for (std::size_t at = text.find("NaN"); at != std::string::npos; at = text.find("NaN"))
    text.replace(at, 3, "null");
  return json::parse(text);
}

/// Counts the numbers that were compared.
class DigitComparison {
 public:
  void expect(const json& reference, const std::string& path, const std::optional<double>& value,
              int decimals) {
    ++num_compared_;
    const json& expected = reference.at(json::json_pointer(path));
    if (expected.is_null()) {
      EXPECT_FALSE(value.has_value()) << path;
      return;
    }
    ASSERT_TRUE(value.has_value()) << path;
    EXPECT_EQ(round_to_decimals(*value, decimals), expected.get<double>()) << path;
  }
  int num_compared() const { return num_compared_; }

 private:
  int num_compared_ = 0;
};

std::optional<double> scaled(const std::optional<double>& value, double factor) {
  if (!value) return std::nullopt;
  return factor * *value;
}

struct Disturbed {
  Trajectory estimate;
  std::vector<FrameLogRow> log;
};

/// Every sixth frame lost, times off by up to 1.1 ms, errors about `sigma` metres and radians.
Disturbed disturb(const Trajectory& truth, double sigma, std::uint64_t seed) {
  RandomStream random(seed);
  Disturbed out;
  for (const TimedPose& frame : truth) {
    FrameLogRow row;
    row.timestamp = frame.timestamp;
    row.latency_ms = random.uniform(1.0, 9.0);
    row.status = "lost";
    if (random.uniform() > 1.0 / 6.0) {
      row.status = random.uniform() < 0.3 ? "detected" : random.uniform() < 0.8 ? "tracked" : "predicted";
      row.pose = frame.pose * Pose::exp(test::normal_vector(random, sigma));
      row.covariance = test::random_covariance(random, sigma);
      out.estimate.push_back({{frame.timestamp.ns + std::llround(random.uniform(-1.1e6, 1.1e6))}, *row.pose});
    }
    out.log.push_back(row);
  }
  return out;
}

void expect_same_bins(const json& reference, const TrajectoryEvaluation& ours, DigitComparison& digits) {
  ASSERT_EQ(reference.at("by_blur_px").size(), ours.by_blur.size());
  for (const BlurBin& bin : ours.by_blur) {
    const std::string name =
        fmt::format("{}-{}", bin.from_px, std::isinf(bin.to_px) ? "" : fmt::format("{}", bin.to_px));
    const std::string path = "/by_blur_px/" + name;
    digits.expect(reference, path + "/frames", bin.summary.frames, 0);
    digits.expect(reference, path + "/coverage", bin.summary.coverage, 4);
    digits.expect(reference, path + "/success_5px", bin.summary.success_5px, 4);
    digits.expect(reference, path + "/median_px", bin.summary.median_px, 4);
    digits.expect(reference, path + "/p95_px", bin.summary.p95_px, 4);
  }
}

void expect_same_summary(const json& reference, const ErrorSummary& ours, DigitComparison& digits) {
  digits.expect(reference, "/frames", ours.frames, 0);
  digits.expect(reference, "/coverage", ours.coverage, 4);
  digits.expect(reference, "/success_5px", ours.success_5px, 4);
  digits.expect(reference, "/median_px", ours.median_px, 4);
  digits.expect(reference, "/p95_px", ours.p95_px, 4);
  digits.expect(reference, "/position_rmse_mm", scaled(ours.position_rmse_m, 1e3), 3);
  digits.expect(reference, "/rotation_rmse_deg", scaled(ours.rotation_rmse_rad, kDegPerRad), 4);
  digits.expect(reference, "/position_median_mm", scaled(ours.position_median_m, 1e3), 3);
  digits.expect(reference, "/rotation_median_deg", scaled(ours.rotation_median_rad, kDegPerRad), 4);
}

void expect_same_log(const json& reference, const FrameLogEvaluation& ours, DigitComparison& digits) {
  EXPECT_EQ(reference.at("status").get<decltype(ours.statuses)>(), ours.statuses);
  digits.expect(reference, "/claimed_good", ours.claimed_good, 0);
  digits.expect(reference, "/claimed_good_but_over_10px", ours.claimed_good_but_over_10px, 0);
  digits.expect(reference, "/claimed_share_of_frames", ours.claimed_share_of_frames, 4);
  digits.expect(reference, "/latency_ms/p50", ours.latency_p50_ms, 3);
  digits.expect(reference, "/latency_ms/p99", ours.latency_p99_ms, 3);
  digits.expect(reference, "/mean_squared_position_error_over_sigma2",
                ours.mean_squared_position_error_over_sigma2, 3);
  digits.expect(reference, "/nees_over_6/mean", ours.nees_over_6_mean, 3);
  digits.expect(reference, "/nees_over_6/median", ours.nees_over_6_median, 3);
}

struct Recording {
  std::string name;
  TrajectoryKind kind;
};

void PrintTo(const Recording& recording, std::ostream* out) {
  *out << recording.name;
}

class ReferenceScores : public ::testing::TestWithParam<Recording> {};

TEST_P(ReferenceScores, TrajectoriesAndLogsGiveTheSameDigits) {
  APRILTRACK_SHARED_OR_SKIP(scorer, "tools/score_track.py");
  APRILTRACK_SHARED_OR_SKIP(sequence, "data/" + GetParam().name);
  APRILTRACK_NEED_JUDGE(test::python_judge(kModules, "python3-numpy, python3-yaml"));
  const std::string python = test::python_with(kModules);
  const Trajectory truth = read_tum(sequence / "truth.tum");
  const CornerScene scene{read_cameras(sequence / "camera.yaml").cameras.front(),
                          read_tag_map(sequence / "map.yaml")};
  const fs::path folder = test::temporary_folder();
  DigitComparison digits;
  for (const double sigma : {1e-3, 2e-2, 0.5}) {
    const Disturbed disturbed = disturb(truth, sigma, 42);
    write_tum(folder / "e.tum", disturbed.estimate);
    write_frame_log(folder / "f.csv", disturbed.log);
    const json reference =
        run_scorer(fmt::format("{} '{}' '{}' '{}' --frames-csv '{}'{}", python, scorer.string(),
                               sequence.string(), (folder / "e.tum").string(), (folder / "f.csv").string(),
                               GetParam().kind == TrajectoryKind::kJoint ? " --joint" : ""));
    const auto ours =
        evaluate_trajectory(truth, read_tum(folder / "e.tum"), &scene, {GetParam().kind, false});
    expect_same_summary(reference, ours.overall, digits);
    expect_same_bins(reference, ours, digits);
    expect_same_log(reference, evaluate_frame_log(ours, read_frame_log(folder / "f.csv")), digits);
  }
  EXPECT_GE(digits.num_compared(), 3 * (9 + 5 + 8));
}

void expect_same_distribution(const json& reference, const std::string& path, const Distribution& ours,
                              double factor, int decimals, DigitComparison& digits) {
  digits.expect(reference, path + "/median", factor * ours.median, decimals);
  digits.expect(reference, path + "/max", factor * ours.max, decimals);
}

TagMap disturb(const TagMap& truth, double sigma, bool has_covariances) {
  RandomStream random(7);
  TagMap map = truth;
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    MapTag& tag = map.tags[i];
    if (has_covariances) tag.covariance = i == 1 ? Matrix6d::Zero() : test::random_covariance(random, sigma);
    tag.T_map_tag =
        Pose::exp(Vector6d::Constant(0.3)) * tag.T_map_tag * Pose::exp(test::normal_vector(random, sigma));
  }
  if (map.tags.size() > 4) map.tags.pop_back();
  MapTag extra = map.tags.front();
  extra.key.id = 400;
  map.tags.push_back(extra);
  return map;
}

TEST_P(ReferenceScores, MapsGiveTheSameDigits) {
  APRILTRACK_SHARED_OR_SKIP(scorer, "tools/score_map.py");
  APRILTRACK_SHARED_OR_SKIP(truth_file, "data/" + GetParam().name + "/map.yaml");
  APRILTRACK_NEED_JUDGE(test::python_judge(kModules, "python3-numpy, python3-yaml"));
  const std::string python = test::python_with(kModules);
  const TagMap truth = read_tag_map(truth_file);
  const fs::path file = test::temporary_folder() / "m.yaml";
  DigitComparison digits;
  for (const double sigma : {1e-3, 2e-2, 0.3}) {
    write_tag_map(file, disturb(truth, sigma, truth.tags.size() > 2));
    const json reference = run_scorer(
        fmt::format("{} '{}' '{}' '{}'", python, scorer.string(), truth_file.string(), file.string()));
    const MapComparison ours = compare_maps(truth, read_tag_map(file));
    digits.expect(reference, "/compared", static_cast<double>(ours.tags.size()), 0);
    EXPECT_EQ(reference.at("extra"), json::array({400}));
    EXPECT_EQ(reference.at("missing").size(), ours.missing.size());
    digits.expect(reference, "/position_mm/rms", 1e3 * ours.position_m.rms, 4);
    digits.expect(reference, "/rotation_deg/rms", kDegPerRad * ours.rotation_rad.rms, 4);
    expect_same_distribution(reference, "/position_mm", ours.position_m, 1e3, 4, digits);
    expect_same_distribution(reference, "/rotation_deg", ours.rotation_rad, kDegPerRad, 4, digits);
    if (truth.tags.size() < 3) continue;
    digits.expect(reference, "/worst_tag", ours.tags[ours.worst].key.id, 0);
    digits.expect(reference, "/scale", ours.scale, 6);
    ASSERT_TRUE(ours.nees_over_6.has_value());
    digits.expect(reference, "/nees_over_6/mean", ours.nees_over_6->mean, 3);
    expect_same_distribution(reference, "/nees_over_6", *ours.nees_over_6, 1.0, 3, digits);
  }
  EXPECT_GE(digits.num_compared(), 3 * 7);
}

INSTANTIATE_TEST_SUITE_P(Recordings, ReferenceScores,
                         ::testing::Values(Recording{"room_gentle", TrajectoryKind::kEgo},
                                           Recording{"room_blur", TrajectoryKind::kEgo},
                                           Recording{"bundle_blur", TrajectoryKind::kJoint},
                                           Recording{"single_blur", TrajectoryKind::kJoint}),
                         [](const auto& recording) { return recording.param.name; });

}  // namespace
}  // namespace apriltrack
