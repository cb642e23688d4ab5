#pragma once

#include <vector>

#include "active_tags.h"
#include "nearby_tags.h"

namespace apriltrack {

/// Memory that fits and scores use again, from frame to frame.
struct PhotometricScratch {
  explicit PhotometricScratch(const std::vector<PhotometricTag>& tags) : nearby(tags) {}

  NearbyTags nearby;  ///< What is chosen of the tags, about the poses asked about of late.
  ActiveTags active;
  PredictedPixels predicted;
  std::vector<float> weights;
  SweptRows swept_rows;
};

}  // namespace apriltrack
