#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/map_state.h"

namespace apriltrack {

/// What each view of a tag counts, of one view: those that follow each other from nearly one place share one.
/// Gloss, shadows and light lie on the same part of a tag there, so that the views err alike, by more than a
/// detector can know of each. lines_of_sight: from the camera to the tag, in the order of time.
std::vector<double> viewpoint_shares(const std::vector<Eigen::Vector3d>& lines_of_sight);

/// The same of each of the views, among those of its tag and camera, where the state has tag and frames. 1
/// for those of which the detector claims nothing. views: in the order of time.
std::vector<double> viewpoint_shares(const Observations& observations, const MapState& state,
                                     const std::vector<std::size_t>& views);

/// What the tag's views count on average, of one view, where the state has tag and frames. 1 where the
/// detector claims nothing.
double mean_viewpoint_share(const Observations& observations, const MapState& state,
                            const std::vector<std::size_t>& views, int tag);

}  // namespace apriltrack
