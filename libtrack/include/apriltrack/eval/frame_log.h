#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/pose.h"

namespace apriltrack {

/// One line of the frame log (`--frames-csv`): there is one for EVERY frame of the recording.
struct FrameLogRow {
  Timestamp timestamp;
  std::string status;  ///< detected, tracked, predicted, lost, unreadable.
  std::optional<Pose> pose;
  int tags_detected = 0;  ///< Tags of the map that were read; the blur tracker seldom looks for all of them.
  int tags_tracked = 0;   ///< Those whose evidence the pose rests on, read or not.
  std::optional<double> latency_ms;  ///< From the decoded image to the result.
  double second_mode_odds = 0.0;
  std::optional<Matrix6d> covariance;  ///< Right perturbation of the pose, [translation; rotation].
  /// RMS error of the whole position (rotation) vector that the tracker expects. Reading fills them from the
  /// file's own columns; writing derives them from the covariance where there is one.
  std::optional<double> sigma_position_m = std::nullopt;
  std::optional<double> sigma_rotation_rad = std::nullopt;
  std::optional<double> detection_ms = std::nullopt;  ///< Of latency_ms, looking for tags that can be read.
};

/// True for `detected` and `tracked`: the tracker claims to see a tag in this frame.
bool claims_evidence(const FrameLogRow& row);

/// Throws Error(kIo); an existing file is replaced only when the new one is complete.
void write_frame_log(const std::filesystem::path& path, const std::vector<FrameLogRow>& rows);
/// Columns are found by their names; further ones are passed over. Throws Error(kIo) when unreadable,
/// Error(kInvalidInput) with file, line and column when a value is wrong.
std::vector<FrameLogRow> read_frame_log(const std::filesystem::path& path);

}  // namespace apriltrack
