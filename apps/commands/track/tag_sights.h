#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/motion/track_mode.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack::app {

/// What became of one tag in one frame.
enum class SightStatus {
  kDetected,   ///< It was read, and the pose rests on it.
  kTracked,    ///< It was not, and the pose rests on its pixels.
  kOccluded,   ///< It should be seen at the pose, and is not, or not enough of it.
  kHidden,     ///< It has not been for some time, and takes no part.
  kElsewhere,  ///< It was read, and not where the pose puts it.
  kSuspect,    ///< Others showed that it is not where the map has it.
  kUnjudged,   ///< It was read in a frame whose pose rests on no tag, or that has none.
  kUnmapped,   ///< It was read, and the map does not have it.
};

/// All there are, in the order of the enum.
std::span<const SightStatus> sight_statuses();
/// "detected", "tracked", ...
std::string to_string(SightStatus status);

/// A tag in view: one that was read, or that the method judged at its pose.
struct TagSight {
  TagKey tag;
  SightStatus status = SightStatus::kDetected;
  bool is_read = false;  ///< Its code was decoded.
  // Of methods that look at pixels; see TagReport.
  std::optional<double> log_odds, expected_share, found_share, shift_px;
  /// Where the pose puts its corners; none without a pose, or where the lens does not show one of them.
  std::optional<std::array<Eigen::Vector2d, 4>> projected_px;
  /// Root mean square distance of the corners that were read from these.
  std::optional<double> residual_px;
  /// Root mean square of what these may be off by, as the pose's covariance has it.
  std::optional<double> sigma_px;
};

struct SightContext {
  const Camera& camera;
  const TagMap& map;
  TrackMode mode = TrackMode::kEgo;
};

/// Sorted by tag. detections: all that was read in the frame.
std::vector<TagSight> tag_sights(const TrackResult& result, std::span<const Detection> detections,
                                 const SightContext& context);

}  // namespace apriltrack::app
