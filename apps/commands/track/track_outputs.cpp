#include "track_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/frame_log.h"
#include "apriltrack/eval/trajectory_formats.h"
#include "apriltrack/io/staged_files.h"
#include "commands/track/page/track_report.h"
#include "files/loss_words.h"

namespace apriltrack::app {
namespace {

namespace fs = std::filesystem;

/// Whether it is the log of a run that gave poses, or none at all: somebody may want to keep it.
bool is_worth_keeping(const fs::path& frame_log) {
  if (!fs::is_regular_file(frame_log) || fs::is_empty(frame_log)) return false;
  try {
    return std::ranges::any_of(read_frame_log(frame_log),
                               [](const FrameLogRow& row) { return row.pose.has_value(); });
  } catch (const Error&) {
    return true;
  }
}

/// When the run is over, as a file of poses alone.
bool writes_trajectory(const TrackArguments& arguments) {
  return !arguments.streams_poses() && !arguments.writes_mcap();
}

/// What the trajectory's format does not hold, or wants and has not; reported, and for machines.
nlohmann::json report_losses(const TrackArguments& arguments) {
  if (!writes_trajectory(arguments)) return nlohmann::json::array();
  const TrajectoryFormat format = arguments.trajectory_format();
  return report_losses(trajectory_losses(arguments.output, format),
                       {ConversionStep::Stage::kWrite, info_of(format).title, arguments.output},
                       arguments.console);
}

}  // namespace

std::vector<OutputFile> output_files(const TrackArguments& arguments) {
  const bool is_file = !arguments.streams_poses();
  const OutputKind kind = arguments.writes_mcap() ? OutputKind::kMcap : OutputKind::kText;
  std::vector<OutputFile> files = {{is_file ? arguments.output : "", "--output", kind},
                                   {arguments.frames_csv, "--frames-csv"},
                                   {arguments.tags_csv, "--tags-csv"},
                                   {arguments.video, "--video", OutputKind::kVideo},
                                   {arguments.report, "--report"}};
  if (writes_trajectory(arguments) && arguments.trajectory_format() == TrajectoryFormat::kKitti)
    files.push_back({kitti_times_of(arguments.output, "--output"), "--output"});
  return files;
}

bool writes_frame_log(const TrackArguments& arguments, const TrackRecord& record) {
  if (arguments.frames_csv.empty()) return false;
  return record.has_pose() || !is_worth_keeping(arguments.frames_csv);
}

void write_outputs(const TrackArguments& arguments, const TrackRun& tracked, bool with_frame_log,
                   FrameSinks& sinks) {
  const TrackRecord& record = tracked.record;
  StagedFiles outputs;
  if (!arguments.report.empty())
    outputs.write(arguments.report, [&](const fs::path& path) { write_track_report(path, tracked); });
  if (with_frame_log)
    outputs.write(arguments.frames_csv, [&](const fs::path& path) { write_frame_log(path, record.rows()); });
  if (record.has_pose()) {
    if (writes_trajectory(arguments))
      stage_trajectory_as(outputs, arguments.output, record.trajectory(), arguments.trajectory_format());
    sinks.close(outputs);
  }
  outputs.commit();
  if (record.has_pose()) sinks.commit();
}

std::string told_of_frame_log(const TrackArguments& arguments, bool is_written) {
  if (arguments.frames_csv.empty()) return "";
  return is_written
             ? fmt::format(" (each frame's status: {})", arguments.frames_csv)
             : fmt::format(" ({} is kept: of a run with poses, or no frame log)", arguments.frames_csv);
}

void finish(const TrackArguments& arguments, const TrackRecord& record, const ResponseFinding& response,
            const CornerClaims& claims, bool was_interrupted) {
  nlohmann::json summary = record.summary();
  summary["mode"] = arguments.mode;
  summary["tags"] = record.tag_tally().json();
  if (arguments.detections.empty())
    summary["response"] = json_of(response);
  else
    summary["corner_claims"] = json_of(claims);
  summary["method"] = arguments.method();
  summary["interrupted"] = was_interrupted;
  summary["output"] = arguments.output;
  summary["losses"] = report_losses(arguments);
  std::string text =
      fmt::format("{}\n{}: {}", record.text(), arguments.mode == "ego" ? "T_world_camera" : "T_camera_body",
                  arguments.output);
  if (!arguments.frames_csv.empty()) {
    summary["frames_csv"] = arguments.frames_csv;
    text += "\nframe log: " + arguments.frames_csv;
  }
  if (!arguments.tags_csv.empty()) {
    summary["tags_csv"] = arguments.tags_csv;
    text += "\ntag log: " + arguments.tags_csv;
  }
  if (!arguments.video.empty()) {
    summary["video"] = arguments.video;
    text += "\nvideo: " + arguments.video;
  }
  if (!arguments.report.empty()) {
    summary["report"] = arguments.report;
    text += "\nreport: " + arguments.report;
  }
  arguments.console.finish(summary, text);
}

}  // namespace apriltrack::app
