#pragma once

#include <set>

#include "observations/observations.h"

namespace apriltrack {

struct RestingFrames {
  int merged = 0;  ///< Moments that are in the mean of another one.
  int places = 0;  ///< Means of two moments or more.
};

/// Takes moments that show the same scene from the same place for one: the mean of their corners.
///
/// What errs at such a place (lens, light, the corner's lie among the pixels) is common to its frames and
/// does not average, so that they are worth one view with little noise, however long the camera stood.
/// Moments are of one place where over three quarters of the views that they share differ by at most
/// `same_place_px` (rms over a tag's corners). Only moments that show the same tags are averaged, as else
/// tags would be put together from different times; sets of tags of which others show every two together are
/// dropped. A view far off the median of its place is dropped; where over a tenth of a tag's are, it moves,
/// and those moments are a place of their own.
///
/// kept: times of moments that stay as they are. A mean is put at the moment that is nearest to it.
RestingFrames merge_resting_frames(Observations& observations, double same_place_px, const EdgeNoise& noise,
                                   const std::set<Timestamp>& kept);

}  // namespace apriltrack
