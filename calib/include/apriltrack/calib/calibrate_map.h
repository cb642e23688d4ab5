#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tags/tag_sizes.h"

namespace apriltrack {

struct CalibrationOptions {
  /// The tag that is held at the map's origin; by default the first (smallest key) tag of the largest part.
  std::optional<TagKey> held_tag;
  double corner_sigma_px = 0.15;  ///< Expected corner error per axis; scales the covariance only until residuals say more.
  int min_views = 2;              ///< Tags seen in fewer frames are left out and named.
  int max_iterations = 100;
  int num_threads = 1;

  void check() const;
};

/// A part of the recording whose tags are joined by frames that show them together.
struct MapPart {
  std::vector<TagKey> tags;
};

struct CalibrationResult {
  TagMap map;                      ///< The part with the held tag.
  std::vector<TagMap> other_parts; ///< Parts that no frame joins to it, each with a gauge of its own; largest first.
  std::vector<std::string> warnings;
  std::vector<TagKey> left_out;    ///< Seen, but not mapped: too few views, or never together with another tag.
  double residual_rms_px = 0.0;    ///< Per axis, of the observations used.
  int frames_used = 0;
  int observations_used = 0;
  int observations_rejected = 0;
};

/// Builds a tag map by bundle adjustment: connectivity first, planar solutions resolved, spanning-tree start, robust
/// adjustment with one tag held (docs/algorithms/calibration.md).
///
/// Throws Error(kNoResult) when no two tags connect, ids are not unique, or the adjustment does not converge, and says
/// what to do; Error(kInvalidInput) when a size is missing or the held tag was never seen.
CalibrationResult calibrate_map(std::span<const FrameDetections> frames, const CameraRig& rig, const TagSizes& sizes,
                                const CalibrationOptions& options, const LogSink& log = silent_log());

}  // namespace apriltrack
