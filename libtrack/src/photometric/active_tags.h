#pragma once

#include <vector>

#include "apriltrack/photometric/photometric_world.h"
#include "tag_photometry.h"
#include "tag_pixels.h"
#include "tag_prediction.h"

namespace apriltrack {

/// A tag that shows enough of itself on one level, with the pixels that it is judged by.
struct ActiveTag {
  int index = 0;  ///< Into PhotometricWorld::tags.
  TagPixels pixels;
  PredictedPixels predicted;  ///< At the state that it was found for.
  double scale = 0.0;         ///< Of the residuals; 0 until it is measured.
  double path_px = 0.0;
};

/// The tags that `state` shows, but for those known to be hidden. max_pixels: of each tag; less where more
/// than 14 share a frame's budget (docs/algorithms/blur_tracker.md, section 2).
std::vector<ActiveTag> active_tags(PhotometricWorld& world, const PhotometricFrame& frame,
                                   const MotionState& state, int level, int max_pixels,
                                   double extra_sigma_px = 0.0, bool with_hidden = false);

/// The residuals' scale that a first, plain fit of the colours shows, with a floor for what no model
/// explains.
double scale_of(const TagMisfit& misfit);

}  // namespace apriltrack
