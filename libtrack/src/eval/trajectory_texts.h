#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/eval/trajectory_formats.h"

namespace apriltrack {

// The formats of trajectories as texts. name: of the file, in messages. All readers throw
// Error(kInvalidInput) with file, line and column where a row is wrong.

Trajectory read_tum_text(std::string_view text, const std::string& name);

/// Whether the rows are separated by commas, as those of EuRoC are.
bool has_comma_columns(std::string_view text);
/// losses: gets the columns that a trajectory has no place for.
Trajectory read_euroc_text(std::string_view text, const std::string& name,
                           std::vector<ConversionLoss>& losses);
std::string euroc_text(const Trajectory& trajectory);

/// Whether the first row has twelve columns, separated by blanks.
bool has_kitti_columns(std::string_view text);
/// One for each pose, in the file's order, which need not be that of time.
std::vector<Pose> read_kitti_text(std::string_view text, const std::string& name);
std::vector<Timestamp> read_kitti_times_text(std::string_view text, const std::string& name);
std::string kitti_text(const Trajectory& trajectory);
std::string kitti_times_text(const Trajectory& trajectory);

}  // namespace apriltrack
