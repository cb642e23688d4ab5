#pragma once

#include <deque>
#include <optional>

#include "apriltrack/photometric/motion_fit.h"
#include "apriltrack/tracker/track_result.h"
#include "exposure_estimate.h"
#include "frame_pace.h"
#include "path_ratio.h"

namespace apriltrack {

/// A frame's exposure: what is told, or usual where nothing is, times what the motion so far makes of it.
struct FrameExposure {
  double exposure_s = 0.0;  ///< To explain the frame with.
  double base_s = 0.0;      ///< As told, or usual.
  bool is_told = false;
  bool is_estimated = false;  ///< The motion has said something of it.
  double sigma = 0.0;         ///< Standard deviation of the logarithm of exposure_s.

  ExposureReport report() const {
    return {exposure_s, is_told ? std::optional(base_s) : std::nullopt, is_estimated, sigma};
  }
};

/// The exposures of one recording's frames (docs/algorithms/blur_tracker.md, section 4): learned from the
/// frames that are claimed, apart for frames that tell theirs and for those that do not.
class FrameExposures {
 public:
  FrameExposures(const MotionNoise& noise, double usual_s);

  /// Of the next frame.
  FrameExposure next(Timestamp time, const std::optional<double>& told_s);

  /// After a frame that was claimed. What its velocity is to be multiplied by: the path is what was seen.
  double claimed(Timestamp time, const FrameExposure& exposure, const PhotometricWorld& world,
                 const MotionFit& fit);

 private:
  const ExposureEstimate& estimate(const FrameExposure& of) const { return of.is_told ? told_ : untold_; }

  MotionNoise noise_;
  double usual_s_;
  ExposureEstimate told_, untold_;
  FramePace pace_;
  std::optional<Timestamp> last_time_;
  std::deque<BlurredInstant> instants_;  ///< Of one kind, three at most.
  bool are_told_ = false;
};

}  // namespace apriltrack
