#pragma once

#include <optional>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

/// One image of one camera, as it came: 8-bit grey, in the camera's response.
struct Frame {
  GrayView image;       ///< Not owned; must outlive the call that it is passed to.
  Timestamp timestamp;  ///< Middle of the exposure.
  /// Of this frame; else the camera's own value holds. What is neither 0 nor from kMinExposure_s to
  /// kMaxExposure_s is as if it were not told, with a TrackResult::warning.
  std::optional<double> exposure_s;
  double gain = 1.0;     ///< Relative to the first frame of the recording.
  int camera_index = 0;  ///< Into the rig's cameras; the camera itself is passed beside the frame.
};

}  // namespace apriltrack
