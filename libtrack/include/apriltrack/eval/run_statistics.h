#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/eval/frame_log.h"

namespace apriltrack {

/// The statuses that a frame may have (FrameLogRow::status).
inline constexpr std::array<std::string_view, 5> kFrameStatuses = {"detected", "tracked", "predicted", "lost",
                                                                   "unreadable"};

/// The position in kFrameStatuses; `status` must be one of them.
std::size_t index_of_status(std::string_view status);

/// RMS error of the whole position (rotation) vector that poses claim by their covariances.
struct ClaimedSigma {
  double median_position_m = 0.0;
  double worst_position_m = 0.0;
  double median_rotation_rad = 0.0;
  double worst_rotation_rad = 0.0;
};

struct StatusFigures {
  std::string_view status;  ///< One of kFrameStatuses.
  std::size_t frames = 0;
  std::optional<ClaimedSigma> sigma;  ///< Of the poses that have a covariance.
};

/// Frames one after the other, none of which shows a tag to the tracker: predicted, lost or unreadable.
struct BlindStretch {
  Timestamp first_frame;
  double from_s = 0.0;  ///< Of the last evidence before, or of the first frame; since the first frame.
  double to_s = 0.0;    ///< Of the first evidence after, or of the last frame.
  std::size_t predicted = 0, lost = 0, unreadable = 0;
  std::string reason;  ///< That most of its lost frames give; empty where none is lost.

  double duration_s() const { return to_s - from_s; }
  std::size_t frames() const { return predicted + lost + unreadable; }
};

/// What a user asks of a run of the tracker.
struct RunStatistics {
  std::size_t frames = 0;
  std::size_t with_evidence = 0;                              ///< Detected or tracked.
  double duration_s = 0.0;                                    ///< From the first frame to the last.
  std::array<StatusFigures, kFrameStatuses.size()> statuses;  ///< In the order of kFrameStatuses.
  std::optional<ClaimedSigma> sigma;                          ///< Of all poses.
  std::vector<BlindStretch> blind;                            ///< The longest first.
  std::optional<double> first_pose_s;
  std::size_t from_one_tag = 0;  ///< Poses that rest on evidence, of one tag only.
  std::size_t with_second_pose = 0;
  std::optional<double> latency_p50_ms;
  std::optional<double> latency_p99_ms;
  std::optional<double> latency_max_ms;
  double latency_max_at_s = 0.0;  ///< Of the frame that took so long; since the first frame.
};

/// Statistics of the frame log of a run. rows: at least one. lost_reasons: for each row why it has no pose,
/// empty where it has one or is unreadable.
RunStatistics run_statistics(std::span<const FrameLogRow> rows, std::span<const std::string> lost_reasons);

}  // namespace apriltrack
