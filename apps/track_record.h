#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apriltrack/detect/detection.h"
#include "apriltrack/eval/frame_log.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack::app {

/// What a run of `track` leaves behind, frame by frame.
class TrackRecord {
 public:
  /// latency_s: from the decoded image to the result.
  void add(const FrameDetections& frame, const TrackResult& result, double latency_s);
  void add_unreadable(Timestamp timestamp);

  /// Throws Error(kNoResult) that tells why a whole recording gave no pose, and what to do.
  void check_has_pose(const std::string& input, const TagMap& map) const;

  struct SeveralTags {
    std::size_t frames = 0;
    std::size_t without_pose = 0;
  };
  /// Frames in which two mapped tags or more were detected, and those of them that gave no pose: at best it
  /// was predicted.
  SeveralTags frames_with_several_tags() const;

  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<FrameLogRow>& rows() const { return rows_; }

  /// Counts and latencies, for machines and for people.
  nlohmann::json summary() const;
  std::string text() const;

 private:
  std::size_t num_lost() const { return rows_.size() - trajectory_.size() - num_unreadable_; }
  std::size_t count(TrackStatus status) const;
  double latency_ms(double fraction) const;

  Trajectory trajectory_;
  std::vector<FrameLogRow> rows_;
  std::vector<double> latencies_ms_;
  std::map<TagKey, int> frames_by_tag_;      ///< Everything detected, mapped or not.
  std::map<std::string, int> lost_reasons_;  ///< Frames without a pose, by cause.
  std::size_t num_unreadable_ = 0;
};

}  // namespace apriltrack::app
