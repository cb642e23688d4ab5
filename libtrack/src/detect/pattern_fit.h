#pragma once

#include <Eigen/Core>
#include <optional>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/tags/tag_family.h"
#include "edge_frame.h"
#include "light_sampler.h"

namespace apriltrack {

/// A tag's whole pattern fitted to the pixels that show it.
struct FittedPattern {
  Quad corners_px;
  /// Of the corners' errors, x0 y0 x1 y1 ..., px^2: what the pixels' noise makes them err.
  Eigen::Matrix<double, 8, 8> covariance_px2;
  /// Covariance of the blur by lens and motion, px^2; the pixel's own area is not in it.
  Eigen::Matrix2d blur_px2;
  double contrast = 0.0;      ///< White less black, linear light.
  double residual_rms = 0.0;  ///< Over the contrast; outliers count less.
  double used_share = 0.0;    ///< What outliers leave of the pixels, by weight.
  double used_edges = 0.0;    ///< The same of what pixels tell of the place: the light's gradient, squared.
};

/// What the fit begins with, and what it knows.
struct PatternFitStart {
  Quad corners_px;                      ///< Right to half a cell.
  double blur_sigma_px = 0.6;           ///< About; the pixel's own area included.
  const CameraModel* camera = nullptr;  ///< Its lens bends the tag's edges; null: it is not known.
};

/// Fits the pattern under a homography, a Gaussian blur, even slopes of light, and an unknown surface beyond
/// each side of the print to linear light, robustly (docs/algorithms/detector.md, section 5).
///
/// Where the camera is known the homography holds in coordinates straightened by its lens; else a bend of the
/// size that lenses have is fitted as well. nullopt where the pixels do not show the pattern, or do not
/// settle its place.
std::optional<FittedPattern> fit_pattern(const LightSampler& light, const TagPattern& pattern,
                                         const PatternFitStart& start);

/// The pattern without its outermost ring of cells: of a tag that is cut out along its border.
TagPattern without_margin(const TagPattern& pattern);

}  // namespace apriltrack
