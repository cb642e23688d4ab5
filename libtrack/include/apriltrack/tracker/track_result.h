#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/motion/track_mode.h"
#include "apriltrack/tags/tag_key.h"

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
  /// All tags that were read in this frame, mapped or not. A tracker that knows where it is looks only where
  /// tags are expected, and not at all at what is too blurred to be read.
  std::vector<Detection> detections;
  int tags_detected = 0;  ///< Mapped tags among them.
  int tags_tracked = 0;   ///< Mapped tags whose evidence the pose rests on.
  /// Mapped tags read in this frame, once and without a corrected bit, that are not where the pose puts them:
  /// moved since the map was made, or the camera file is of another camera. Empty without evidence.
  std::vector<TagKey> contradicting_tags;
  /// Another pose that explains the frame (the mirrored tilt of a lone tag; the reverse of a blurred path),
  /// where it cannot be ruled out.
  std::optional<Pose> second_pose;
  double second_mode_odds = 0.0;  ///< Weight of second_pose over pose; 0 when there is none.
  double latency_s = 0.0;         ///< From the decoded image to the result.
  std::string reason;             ///< Why there is no pose; empty otherwise.
};

}  // namespace apriltrack
