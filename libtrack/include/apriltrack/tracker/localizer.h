#pragma once

#include <memory>
#include <optional>

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
  /// Of corners without a covariance, per axis, from the detector's own tests: sharp frames, linear light.
  double corner_sigma_px = 0.1;
  /// Tags whose corners fit worse (root mean square per axis) are left out, unless so much is expected of
  /// them.
  double max_residual_rms_px = 4.0;

  void check() const;
};

/// Localises by detection: every mapped tag's corners in one robust adjustment (`--method pnp`).
///
/// What most robots do today, done well: linear-light corners, both planar solutions of every tag kept, tags
/// that disagree dropped. Two explanations of the same corners (a lone tag, or few in one plane) are weighed
/// by their fit and by the poses of the last 0.3 s, moved on with constant velocity; the lesser one is
/// reported beside the pose.
///
/// A reading that chance may make, of tag16h5 above all, gives no pose by itself, outvotes no tag read for
/// sure and accuses none of having moved: hang tags of few bits so that two are in view, or use tag36h11. The
/// only tag of a map needs no second, where no bit was corrected.
///
/// Corners are weighed by Detection::covariance_px2, or corner_sigma_px without it; what is far off is judged
/// in the same unit. The pose's covariance follows from these, the residuals, the covariances of the map's
/// tags (their errors taken as independent) and the acceleration during the exposure
/// (docs/algorithms/localizer.md).
///
/// One image at a time; give each thread its own. No frame throws, whatever it shows (once prepare() has been
/// called: before, the first image may run out of memory for the tables): a pose is finite, or there is none
/// and the result says why.
class Localizer {
 public:
  /// Throws Error(kInvalidInput) where the map is not as check_tag_map() wants it, or an option out of range.
  Localizer(const Camera& camera, const TagMap& map, const LocalizerOptions& options = {});
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  /// Builds the detector's tables now: up to seconds, and memory, for families with many codes. Without it
  /// the first image does; its latency_s does not count them. Those who bring detections need none.
  void prepare();

  /// Frames come in the order of time. An image of another resolution than the camera's is lost; its reason
  /// names both.
  TrackResult localize(const Frame& frame);
  /// The same from detections made elsewhere, for instance several frames at a time.
  /// exposure_s: of this frame; else, and with a warning where it is neither 0 nor from kMinExposure_s to
  /// kMaxExposure_s, the camera's own value holds.
  TrackResult localize(const FrameDetections& detections, std::optional<double> exposure_s = std::nullopt);

  /// What localize(Frame) detects with: the options given, with the map's families and the camera's response.
  const DetectorOptions& detector_options() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace apriltrack
