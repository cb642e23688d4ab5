#pragma once

#include <optional>
#include <string>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/motion/track_mode.h"

namespace apriltrack {

enum class TrackStatus {
  kDetected,    ///< The pose rests on a detection in this frame.
  kTracked,     ///< Photometric evidence, no detection.
  kPredicted,   ///< Motion model only; at most 0.5 s after the last evidence.
  kLost,        ///< No pose.
  kUnreadable,  ///< The frame could not be decoded.
};

/// The word used in files and messages: "detected", "tracked", ...
std::string to_string(TrackStatus status);

/// What one frame says of the pose.
struct TrackResult {
  Timestamp timestamp;
  TrackStatus status = TrackStatus::kLost;
  /// T_world_camera (ego) or T_camera_body (joint); none when lost or unreadable.
  std::optional<Pose> pose;
  /// Of the right perturbation of `pose`, [translation; rotation], m and rad.
  std::optional<Matrix6d> covariance;
  int tags_detected = 0;  ///< Mapped tags found in this frame.
  int tags_tracked = 0;   ///< Mapped tags whose evidence the pose rests on.
  /// The other explanation of the same corners (planar ambiguity), where it cannot be ruled out.
  std::optional<Pose> second_pose;
  double second_mode_odds = 0.0;  ///< Weight of second_pose over pose; 0 when there is none.
  double latency_s = 0.0;         ///< From the decoded image to the result.
  std::string reason;             ///< Why there is no pose; empty otherwise.
};

}  // namespace apriltrack
