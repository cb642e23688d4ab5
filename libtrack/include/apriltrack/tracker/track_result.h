#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/motion/track_mode.h"
#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

enum class TrackStatus {
  kDetected,    ///< The pose rests on a detection in this frame.
  kTracked,     ///< Photometric evidence, no detection.
  kPredicted,   ///< Motion model, or evidence too vague to be claimed; at most 0.5 s after the last that was.
  kLost,        ///< No pose.
  kUnreadable,  ///< The frame could not be decoded, or has not the camera's resolution.
};

/// The word used in files and messages: "detected", "tracked", ...
std::string to_string(TrackStatus status);

/// What a tag of the map, in view, says of the pose.
enum class TagState {
  kUsed,       ///< It is seen where it should be: the pose rests on it, among others.
  kOccluded,   ///< It is not, or not enough of it: something is before it.
  kHidden,     ///< Not for some time: a wall, a door. It takes no part until it is seen.
  kElsewhere,  ///< It was read, once and without a corrected bit, but not where the pose puts it.
  kSuspect,    ///< Others showed that it is not where the map has it. It takes no part until it fits again.
};

/// The word used in messages: "used", "occluded", ...
std::string to_string(TagState state);

/// One tag's evidence in one frame.
struct TagReport {
  TagKey tag;
  TagState state = TagState::kUsed;
  /// With its picture in the map, at the pose: 1 is all of what is seen, noise aside.
  double correlation = 0.0;
  /// What its corners would move by, were it free of the map, root mean square; large where it hardly tells.
  /// None where it is not seen well enough, or the tracker does not tell.
  std::optional<double> shift_px;
  bool is_read = false;  ///< Its code was decoded in this frame.
  /// Of its pixels' variance, the share that its picture explains at the pose, and the share that is there to
  /// be explained: the rest is noise from pixel to pixel.
  double found_share = 0.0, expected_share = 1.0;
  /// Of "it is there" over "it is not", by its pixels; nats.
  double log_odds = 0.0;
};

/// The exposure that a frame's blur was explained with.
struct ExposureReport {
  double exposure_s = 0.0;       ///< As told, or usual, times what the motion so far makes of it.
  std::optional<double> told_s;  ///< By the frame, else by the camera.
  bool is_estimated = false;     ///< The motion has said something of it.
  double sigma = 0.0;            ///< Standard deviation of the logarithm of exposure_s.

  /// Over what was told; 1 where nothing was.
  double factor() const { return told_s && *told_s > 0.0 ? exposure_s / *told_s : 1.0; }
  /// What was told is not what the motion says: by more than 10 %, and surely so.
  bool is_doubted() const {
    const double off = std::abs(std::log(factor()));
    return is_estimated && off > 0.1 && off > 3.0 * sigma;
  }
};

/// What one frame says of the pose.
struct TrackResult {
  Timestamp timestamp;
  TrackStatus status = TrackStatus::kLost;
  /// T_world_camera (ego) or T_camera_body (joint); none when lost or unreadable.
  std::optional<Pose> pose;
  /// Of the right perturbation of `pose`, [translation; rotation], m and rad.
  std::optional<Matrix6d> covariance;
  /// In the middle of the exposure, [linear; angular], m/s and rad/s, both in the frame on the right of
  /// `pose`: the camera's own (ego), or the body's (joint). Wherever the blur tracker has a pose.
  std::optional<Vector6d> velocity;
  /// All tags that were read in this frame, mapped or not. A tracker that knows where it is looks only where
  /// tags are expected, and not at all at what is too blurred to be read.
  std::vector<Detection> detections;
  /// Tags that were read and left out. Of the blur tracker, when it searched the whole image.
  std::vector<LeftOutTag> left_out;
  int tags_detected = 0;  ///< Mapped tags among them.
  int tags_tracked = 0;   ///< Mapped tags whose evidence the pose rests on.
  /// Of the mapped tags that are in the image at this pose, and show enough of themselves to be judged, in
  /// the order of the map. Of the blur tracker, in frames that are `detected` or `tracked`.
  std::vector<TagReport> tags;
  /// Mapped tags that are not where the pose puts them: read elsewhere, once and without a corrected bit, or
  /// suspect and in the image. Moved since the map was made, or the camera file is of another camera. Empty
  /// without evidence.
  std::vector<TagKey> contradicting_tags;
  /// Another pose that explains the frame (the mirrored tilt of a lone tag; the reverse of a blurred path),
  /// where it cannot be ruled out.
  std::optional<Pose> second_pose;
  double second_mode_odds = 0.0;           ///< Weight of second_pose over pose; 0 when there is none.
  std::optional<ExposureReport> exposure;  ///< Of trackers that look for blur.
  double latency_s = 0.0;                  ///< From the decoded image to the result;
  double detection_s = 0.0;                ///< of that, looking for tags that can be read.
  std::string reason;                      ///< Why there is no pose; empty otherwise.
  /// What the frame, or the camera, tells and is not believed, and what holds instead; empty otherwise. The
  /// pose is made without it. Other frames may say the same: to be shown once. Not of the paper's tracker.
  std::string warning;
};

}  // namespace apriltrack
