#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/eval/trajectory.h"
#include "apriltrack/io/conversion_loss.h"
#include "apriltrack/io/name_ending.h"

namespace apriltrack {

class StagedFiles;

/// Formats of trajectories that are read and written (docs/file_formats.md).
enum class TrajectoryFormat {
  kTum,    ///< `timestamp tx ty tz qx qy qz qw`, seconds.
  kEuroc,  ///< state_groundtruth_estimate0/data.csv: nanoseconds, position, quaternion w x y z, velocity, ...
  kKitti,  ///< The first three rows of the matrix; times in a file of their own.
};

struct TrajectoryFormatInfo {
  TrajectoryFormat format = TrajectoryFormat::kTum;
  std::string_view name;    ///< "tum", "euroc", "kitti".
  std::string_view title;   ///< For messages: "EuRoC trajectory (.csv)".
  std::string_view ending;  ///< ".tum": of a file that is given a name.
  std::span<const NameEnding> endings = {};
};

/// All there are, in the order of the enum.
const std::vector<TrajectoryFormatInfo>& trajectory_formats();
const TrajectoryFormatInfo& info_of(TrajectoryFormat format);
std::optional<TrajectoryFormat> trajectory_format_named(std::string_view name);
/// By the ending of a name: .tum, .csv, .kitti, and names that end in kitti.txt.
std::optional<TrajectoryFormat> trajectory_format_of_ending(const std::filesystem::path& path);

struct TrajectoryReadOptions {
  /// The times of KITTI's poses: a line in seconds for each. Empty: kitti_times_file() where it is there,
  /// else times.txt beside the poses.
  std::filesystem::path times = {};
  /// In place of times, from 0 on.
  std::optional<double> rate_hz = std::nullopt;
};

struct TrajectoryReading {
  Trajectory trajectory;
  TrajectoryFormat format = TrajectoryFormat::kTum;
  std::vector<ConversionLoss> losses;
};

/// A trajectory in any format, which its content tells, whatever its name is: rows of eight columns are
/// TUM's, of twelve KITTI's, separated by commas EuRoC's. Throws Error(kIo) when a file cannot be read,
/// Error(kInvalidInput) with file and line when a row is wrong, and where KITTI's poses have no times, or not
/// as many.
TrajectoryReading read_trajectory_file(const std::filesystem::path& path,
                                       const TrajectoryReadOptions& options = {});
/// The poses alone.
Trajectory read_trajectory(const std::filesystem::path& path);

/// "run.times.txt" of "run.kitti" and "run.txt": where the times of KITTI's poses are written.
std::filesystem::path kitti_times_file(const std::filesystem::path& poses);

/// What `format` cannot hold, or wants and has not. path: of the poses.
std::vector<ConversionLoss> trajectory_losses(const std::filesystem::path& path, TrajectoryFormat format);

/// Writes with every digit of every number; of KITTI two files, kitti_times_file() the second. Throws
/// Error(kIo); files are replaced only when all is written.
void write_trajectory_as(const std::filesystem::path& path, const Trajectory& trajectory,
                         TrajectoryFormat format);
/// The same, but `files` puts in place what is written, together with what else is in them.
void stage_trajectory_as(StagedFiles& files, const std::filesystem::path& path, const Trajectory& trajectory,
                         TrajectoryFormat format);

}  // namespace apriltrack
