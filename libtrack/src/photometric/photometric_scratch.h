#pragma once

#include <vector>

#include "active_tags.h"

namespace apriltrack {

/// Memory that fits and scores use again, from frame to frame.
struct PhotometricScratch {
  ActiveTags active;
  PredictedPixels predicted;
  std::vector<float> weights;
};

}  // namespace apriltrack
