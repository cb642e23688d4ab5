#include "demo_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>

#include "apriltrack/eval/statistics.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack::app {
namespace {

/// Sharp enough to decode, then ever less so.
struct Range {
  double from_px, to_px;
  const char* name;
};
constexpr std::array<Range, 3> kBlurRanges = {
    {{0.0, 5.0, "< 5"}, {5.0, 20.0, "5-20"}, {20.0, std::numeric_limits<double>::infinity(), "> 20"}}};

std::vector<FrameScore> predicted_of(const std::vector<FrameScore>& frames,
                                     const std::vector<FrameLogRow>& log) {
  std::set<std::int64_t> times_ns;
  for (const FrameLogRow& row : log) {
    if (row.status == to_string(TrackStatus::kPredicted)) times_ns.insert(row.timestamp.ns);
  }
  std::vector<FrameScore> predicted;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(predicted),
               [&](const FrameScore& frame) { return times_ns.contains(frame.timestamp.ns); });
  return predicted;
}

DemoScore score(const DemoFiles& files, const DemoScene& scene, const std::string& method) {
  const auto recording = files.recording(scene);
  const CornerScene corners{read_cameras(recording / "camera.yaml").cameras.front(),
                            read_tag_map(recording / "map.yaml")};
  const TrajectoryKind kind = scene.mode == TrackMode::kEgo ? TrajectoryKind::kEgo : TrajectoryKind::kJoint;
  const std::vector<FrameLogRow> log = read_frame_log(files.frame_log(scene, method));
  DemoScore result;
  result.scene = &scene;
  result.method = method;
  result.evaluation = evaluate_trajectory(
      read_tum(recording / "truth.tum"), read_tum(files.trajectory(scene, method)), &corners, {.kind = kind});
  result.log = evaluate_frame_log(result.evaluation, log);
  result.predicted = predicted_of(result.evaluation.frames, log);
  return result;
}

std::string whole_percent(std::optional<double> share) {
  return share ? fmt::format("{:.0f} %", 100.0 * *share) : "-";
}

std::string percent_of(int count, int all) {
  return all == 0 ? "-" : whole_percent(static_cast<double>(count) / all);
}

/// Three digits, two of them behind the point at most.
std::string px(double error_px) {
  return fmt::format("{:.{}f}", error_px, error_px < 10.0 ? 2 : error_px < 100.0 ? 1 : 0);
}

constexpr std::ptrdiff_t kFewestForMedian = 5;

/// "0.12 / 0.45 (30/41)": median and 95 % of the poses there are, 30 in 41 frames.
std::string errors(const std::vector<FrameScore>& frames, const Range& range) {
  std::vector<FrameScore> chosen;
  std::copy_if(frames.begin(), frames.end(), std::back_inserter(chosen), [&](const FrameScore& frame) {
    return frame.blur_px >= range.from_px && frame.blur_px < range.to_px;
  });
  const auto poses = std::ranges::count_if(
      chosen, [](const FrameScore& frame) { return frame.corner_error_px.has_value(); });
  const std::string count = fmt::format("({}/{})", poses, chosen.size());
  if (poses < kFewestForMedian) return "- " + count;
  const ErrorSummary s = summarise(chosen, true);
  return fmt::format("{} / {} {}", px(*s.median_px), px(*s.p95_px), count);
}

std::vector<std::string> row(const DemoScore& score) {
  const ErrorSummary& all = score.evaluation.overall;
  std::vector<std::string> cells = {score.scene->name, score.method,
                                    whole_percent(score.log.claimed_share_of_frames),
                                    whole_percent(all.success_5px)};
  for (const Range& range : kBlurRanges) cells.push_back(errors(score.evaluation.frames, range));
  cells.push_back(percent_of(score.log.claimed_good_but_over_10px.value_or(0), score.log.claimed_good));
  cells.push_back(fmt::format("{:.0f}", score.log.latency_p50_ms.value_or(0.0)));
  return cells;
}

}  // namespace

std::vector<DemoScore> score_demo(const DemoFiles& files) {
  std::vector<DemoScore> scores;
  for (const DemoScene& scene : kDemoScenes) {
    for (const char* method : kDemoMethods) scores.push_back(score(files, scene, method));
  }
  return scores;
}

std::string explain_blur_columns() {
  return fmt::format(
      "Blur columns: median / 95 % of the corner error, px (poses / frames of that blur); '-': fewer than {} "
      "poses, too few for a median.",
      kFewestForMedian);
}

DemoTable tabulate(const std::vector<DemoScore>& scores) {
  DemoTable table;
  table.header = {"scene", "method", "claimed", "within 5 px"};
  for (const Range& range : kBlurRanges) table.header.push_back(fmt::format("blur {} px", range.name));
  table.header.insert(table.header.end(), {"claimed, over 10 px", "ms"});
  for (const DemoScore& score : scores) table.rows.push_back(row(score));
  return table;
}

std::string DemoTable::text() const {
  std::vector<std::vector<std::string>> lines = {header};
  lines.insert(lines.end(), rows.begin(), rows.end());
  std::vector<std::size_t> widths(header.size(), 0);
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool is_name = i < 2;
      text +=
          is_name ? fmt::format("{:<{}}  ", line[i], widths[i]) : fmt::format("{:>{}}  ", line[i], widths[i]);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

}  // namespace apriltrack::app
