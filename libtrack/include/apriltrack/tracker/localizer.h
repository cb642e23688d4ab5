#pragma once

#include <memory>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/image/frame.h"
#include "apriltrack/tags/tag_map.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack {

struct LocalizerOptions {
  TrackMode mode = TrackMode::kEgo;
  /// families and response are taken from the map and the camera.
  DetectorOptions detector;
  /// Expected corner error per axis, from the detector's own tests: sharp frames, linear light.
  double corner_sigma_px = 0.15;
  /// A frame whose corners fit worse than this (root mean square per axis, after outliers) gives no pose.
  double max_residual_rms_px = 4.0;

  void check() const;
};

/// Localises by detection: every mapped tag's corners in one robust adjustment (`--method pnp`).
///
/// What most robots do today, done well: linear-light corners, both planar solutions kept, and the ambiguity of a
/// lone tag settled by the previous pose. One image at a time; give each thread its own.
class Localizer {
 public:
  /// Throws Error(kInvalidInput) when the map is empty or names an unknown family.
  Localizer(const Camera& camera, const TagMap& map, const LocalizerOptions& options = {});
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  /// Requires an image of the camera's resolution. Frames come in the order of time.
  TrackResult localize(const Frame& frame);
  /// The same from detections made elsewhere.
  TrackResult localize(const FrameDetections& detections);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace apriltrack
