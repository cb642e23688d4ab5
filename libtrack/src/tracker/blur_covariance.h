#pragma once

#include "apriltrack/photometric/motion_fit.h"

namespace apriltrack {

/// Covariance of a fit: of what its information says, and of what the model leaves out: errors that all
/// pixels of a tag share and that grow with its blur (docs/algorithms/blur_tracker.md, equation 10).
Matrix12d fit_covariance(const PhotometricWorld& world, const MotionFit& fit);

}  // namespace apriltrack
