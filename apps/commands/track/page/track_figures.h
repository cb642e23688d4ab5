#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/tracker/track_result.h"
#include "commands/track/track_record.h"

namespace apriltrack::app {

inline constexpr std::array<TrackStatus, 5> kTrackStatuses = {TrackStatus::kDetected, TrackStatus::kTracked,
                                                              TrackStatus::kPredicted, TrackStatus::kLost,
                                                              TrackStatus::kUnreadable};

/// The position in kTrackStatuses of the word in a row of the frame log.
std::size_t index_of_status(const std::string& word);

/// RMS error of the whole position (rotation) vector that the covariances claim.
struct ClaimedSigma {
  double median_position_m = 0.0;
  double worst_position_m = 0.0;
  double median_rotation_rad = 0.0;
  double worst_rotation_rad = 0.0;
};

struct StatusFigures {
  TrackStatus status = TrackStatus::kLost;
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

/// What a user asks of a run.
struct TrackFigures {
  std::size_t frames = 0;
  std::size_t with_evidence = 0;  ///< Detected or tracked.
  double duration_s = 0.0;        ///< From the first frame to the last.
  std::array<StatusFigures, kTrackStatuses.size()> statuses;
  std::optional<ClaimedSigma> sigma;  ///< Of all poses.
  std::vector<BlindStretch> blind;    ///< The longest first.
  std::optional<double> first_pose_s;
  std::size_t from_one_tag = 0;  ///< Poses that rest on evidence, of one tag only.
  std::size_t with_second_pose = 0;
  std::optional<double> latency_p50_ms;
  std::optional<double> latency_p99_ms;
  std::optional<double> latency_max_ms;
  double latency_max_at_s = 0.0;  ///< Of the frame that took so long; since the first frame.
};

/// Of a run with at least one frame.
TrackFigures figures_of(const TrackRecord& record);

}  // namespace apriltrack::app
