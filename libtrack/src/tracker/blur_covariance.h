#pragma once

#include "apriltrack/photometric/motion_fit.h"

namespace apriltrack {

/// Covariance of a fit: of what its information says, and of what the model leaves out: errors that all
/// pixels of a tag share and that grow with its blur (docs/algorithms/blur_tracker.md, equation 10).
Matrix12d fit_covariance(const PhotometricWorld& world, const MotionFit& fit);

/// What may cover the margin of a tag that no other confirms adds to that of the pose: it stays for many
/// frames, so that it is no part of what one frame tells the next. Zero where nothing seems to.
Matrix6d cover_covariance(const PhotometricWorld& world, const MotionFit& fit);

/// What the map's covariances of the tags seen add to that of the pose (MapUncertainty): the same from frame
/// to frame, so that it is no part of what one frame tells the next. Zero where the map has none.
Matrix6d map_covariance(const PhotometricWorld& world, const MotionFit& fit);

}  // namespace apriltrack
