#pragma once

#include <string>
#include <vector>

#include "apriltrack/tags/tag_key.h"

namespace apriltrack {

// Errors that many views share, so that more views do not average them out.

/// A number of a camera that was estimated with the map.
struct CameraCorrection {
  std::string camera;
  std::string parameter;  ///< "edge offset", "focal length", "fy / fx", "cx", "k1", "translation x", ...
  std::string unit;       ///< "px", "1" (a share, or a coefficient), "m", "rad".
  double value = 0.0;     ///< To be added to what was given; of lengths and ratios a share of that.
  double sigma = 0.0;     ///< Of lengths and ratios a share of what the camera has now.

  bool is_of_edges() const { return parameter == "edge offset"; }  ///< Of the detector, not of the camera.
};

/// Tags that look like two prints of different size: alike among themselves, and one larger than the other.
struct PrintBatches {
  std::vector<TagKey> larger, smaller;
  double log_ratio = 0.0;  ///< Of the one to the other, beside what their stated sizes say.
  double sigma = 0.0;
};

/// Pictures of a camera that are not of the moments that their times say.
struct TimeError {
  enum class Kind {
    kReadout,  ///< Its rows were taken one after another: from the first to the last, s.
    kDelay     ///< All of it was taken later than what `first_camera` saw at the same time: by so much, s.
  };
  std::string camera;
  Kind kind = Kind::kReadout;
  double value_s = 0.0;
  double sigma_s = 0.0;
  std::string first_camera = {};
};

}  // namespace apriltrack
