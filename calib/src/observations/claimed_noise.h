#pragma once

#include <optional>
#include <span>

#include "apriltrack/detect/detection.h"

namespace apriltrack {

/// Errors that a tag keeps in all of its views, px per axis: light that is uneven over it, the grain of paper
/// and print. Residuals show such errors only within a view, as correlated noise, which the detector's
/// covariances count.
struct KeptErrors {
  double corners_px = 0.0;
  double pictures_px = 0.0;  ///< Of a map refined on pictures, which estimates each tag's light.
};

/// As large as what the detector claims for a view: the median of all, over which each view has its own
/// (TagView::kept_share). nullopt where it claims nothing.
///
/// Measured in path-traced recordings against exact truth, tag by tag (docs/algorithms/detector.md, section
/// 5): 0.014 px kept where 0.014 are claimed, and 0.035 where 0.033 are.
std::optional<KeptErrors> kept_errors(std::span<const FrameDetections> frames);

}  // namespace apriltrack
