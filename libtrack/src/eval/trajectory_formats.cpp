#include "apriltrack/eval/trajectory_formats.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/staged_files.h"
#include "apriltrack/io/text_file.h"
#include "trajectory_lines.h"
#include "trajectory_texts.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

constexpr NameEnding kTum[] = {{".tum", true}};
// Tables by commas are many programs', and so are texts.
constexpr NameEnding kCsv[] = {{".csv", true, true}};
constexpr NameEnding kKitti[] = {{".kitti", true}, {"kitti.txt", true, true}};

TrajectoryFormat format_of(std::string_view text) {
  if (has_kitti_columns(text)) return TrajectoryFormat::kKitti;
  return has_comma_columns(text) ? TrajectoryFormat::kEuroc : TrajectoryFormat::kTum;
}

/// Empty where there is none.
fs::path times_beside(const fs::path& poses) {
  std::error_code ignored;
  for (const fs::path& file : {kitti_times_file(poses), poses.parent_path() / "times.txt"})
    if (fs::is_regular_file(file, ignored)) return file;
  return {};
}

std::vector<Timestamp> times_at_rate(std::size_t count, double rate_hz) {
  if (!(rate_hz >= 1e-3 && rate_hz <= 1e6))
    throw invalid_input("--rate", fmt::format("must be in [0.001, 1e6] poses a second (is {})", rate_hz));
  std::vector<Timestamp> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(advance({}, static_cast<double>(i) / rate_hz));
  return times;
}

std::vector<Timestamp> kitti_times(const fs::path& poses, std::size_t count,
                                   const TrajectoryReadOptions& options,
                                   std::vector<ConversionLoss>& losses) {
  if (options.rate_hz) {
    losses.push_back(
        {.kind = LossKind::kTimes, .how = LossHow::kGiven, .value = format_exact(*options.rate_hz) + " Hz"});
    return times_at_rate(count, *options.rate_hz);
  }
  const fs::path file = options.times.empty() ? times_beside(poses) : options.times;
  if (file.empty())
    throw invalid_input(
        poses.string(),
        fmt::format("KITTI's poses have no times: put these beside it as {}, one in seconds a line; or give "
                    "--times FILE or --rate HZ to `trajectory convert`",
                    kitti_times_file(poses).filename().string()));
  std::vector<Timestamp> times = read_kitti_times_text(read_text_file(file, kMaxTableBytes), file.string());
  if (times.size() != count)
    throw invalid_input(file.string(), fmt::format("has {} times, and {} has {} poses: there must be one for "
                                                   "each",
                                                   times.size(), poses.string(), count));
  losses.push_back({.kind = LossKind::kTimes, .how = LossHow::kGiven, .value = file.string()});
  return times;
}

Trajectory read_kitti(const fs::path& path, std::string_view text, const TrajectoryReadOptions& options,
                      std::vector<ConversionLoss>& losses) {
  const std::vector<Pose> poses = read_kitti_text(text, path.string());
  const std::vector<Timestamp> times = kitti_times(path, poses.size(), options, losses);
  std::vector<PoseLine> lines;
  for (std::size_t i = 0; i < poses.size(); ++i) lines.push_back({{times[i], poses[i]}, i + 1});
  return sorted_by_time(std::move(lines), path.string());
}

/// Only KITTI's poses have no times of their own.
void refuse_times(const TrajectoryReadOptions& options, const fs::path& path, TrajectoryFormat format) {
  if (options.times.empty() && !options.rate_hz) return;
  throw invalid_input(options.rate_hz ? "--rate" : "--times",
                      fmt::format("is of KITTI's poses, and {} is a {} with times: leave it out",
                                  path.string(), info_of(format).title));
}

Trajectory read_as(TrajectoryFormat format, const fs::path& path, std::string_view text,
                   const TrajectoryReadOptions& options, std::vector<ConversionLoss>& losses) {
  if (format == TrajectoryFormat::kKitti) return read_kitti(path, text, options, losses);
  refuse_times(options, path, format);
  return format == TrajectoryFormat::kEuroc ? read_euroc_text(text, path.string(), losses)
                                            : read_tum_text(text, path.string());
}

}  // namespace

const std::vector<TrajectoryFormatInfo>& trajectory_formats() {
  static const std::vector<TrajectoryFormatInfo> formats = {
      {TrajectoryFormat::kTum, "tum", "TUM trajectory", ".tum", kTum},
      {TrajectoryFormat::kEuroc, "euroc", "EuRoC trajectory (.csv)", ".csv", kCsv},
      {TrajectoryFormat::kKitti, "kitti", "file of KITTI's poses", ".kitti", kKitti}};
  return formats;
}

const TrajectoryFormatInfo& info_of(TrajectoryFormat format) {
  return trajectory_formats().at(static_cast<std::size_t>(format));
}

std::optional<TrajectoryFormat> trajectory_format_named(std::string_view name) {
  for (const TrajectoryFormatInfo& info : trajectory_formats())
    if (info.name == name) return info.format;
  return std::nullopt;
}

std::optional<TrajectoryFormat> trajectory_format_of_ending(const fs::path& path) {
  return format_of_ending(trajectory_formats(), path);
}

TrajectoryReading read_trajectory_file(const fs::path& path, const TrajectoryReadOptions& options) {
  const std::string text = read_text_file(path, kMaxTableBytes);
  TrajectoryReading reading;
  reading.format = format_of(text);
  reading.trajectory = read_as(reading.format, path, text, options, reading.losses);
  return reading;
}

Trajectory read_trajectory(const fs::path& path) {
  return read_trajectory_file(path).trajectory;
}

fs::path kitti_times_file(const fs::path& poses) {
  return fs::path(poses).replace_extension(".times.txt");
}

std::vector<ConversionLoss> trajectory_losses(const fs::path& path, TrajectoryFormat format) {
  switch (format) {
    case TrajectoryFormat::kEuroc:
      return {{LossKind::kVelocities, LossHow::kAssumed}, {LossKind::kBiases, LossHow::kAssumed}};
    case TrajectoryFormat::kKitti:
      return {
          {.kind = LossKind::kTimes, .how = LossHow::kConverted, .value = kitti_times_file(path).string()}};
    case TrajectoryFormat::kTum:
      break;
  }
  return {};
}

void stage_trajectory_as(StagedFiles& files, const fs::path& path, const Trajectory& trajectory,
                         TrajectoryFormat format) {
  check_trajectory(trajectory);
  const auto write = [&](const fs::path& target, const std::string& text) {
    files.write(target, [&](const fs::path& place) { write_file_atomically(place, text); });
  };
  switch (format) {
    case TrajectoryFormat::kTum:
      return files.write(path, [&](const fs::path& place) { write_tum(place, trajectory); });
    case TrajectoryFormat::kEuroc:
      return write(path, euroc_text(trajectory));
    case TrajectoryFormat::kKitti:
      write(path, kitti_text(trajectory));
      return write(kitti_times_file(path), kitti_times_text(trajectory));
  }
}

void write_trajectory_as(const fs::path& path, const Trajectory& trajectory, TrajectoryFormat format) {
  StagedFiles files;
  stage_trajectory_as(files, path, trajectory, format);
  files.commit();
}

}  // namespace apriltrack
