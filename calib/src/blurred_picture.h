#pragma once

#include "apriltrack/tags/tag_family.h"
#include "normal_distribution.h"

namespace apriltrack {

/// A point of a tag's plane as a lens shows it: its brightness, from 0 for black to 1 for white, and how that
/// changes.
struct PictureSample {
  double light = 0.0;
  double by_u = 0.0, by_v = 0.0;  ///< Per half tag size.
  /// By the logarithm of the blur along each axis.
  double by_log_sigma_u = 0.0, by_log_sigma_v = 0.0;
  /// Share of the blur that lies on printed cells: what lies beyond, nobody knows.
  double known = 0.0;
};

/// A Gaussian blur in a tag's plane, in half tag sizes.
struct PictureBlur {
  double sigma_u = 0.0, sigma_v = 0.0;
  double covariance_uv = 0.0;  ///< Of a plane that is seen askew, smeared along neither axis.
};

/// What a Gaussian about any place along an axis of the plane shares with printed cells.
struct PrintedAxis {
  const NormalTable* normal = nullptr;
  double begin = 0.0, cell = 0.0;  ///< Where the first cell begins, and how wide each is.
  int num_cells = 0;
  double per_cell = 0.0, per_sigma = 0.0;  ///< One over the cell, and over the Gaussian's sigma.
  double reach = 0.0;                      ///< In cells: beyond it hardly anything is left of the Gaussian.
};

/// The printed cells of a tag under a Gaussian blur, in closed form along the axes of the plane, and to
/// second order in what these have in common (docs/algorithms/photometric_refinement.md, equations 1 and 2).
/// Coordinates in half tag sizes, as TagPattern's.
class BlurredPicture {
 public:
  /// pattern: must outlive this. blur: sigmas > 0.
  BlurredPicture(const TagPattern& pattern, const PictureBlur& blur);

  PictureSample at(double u, double v) const;

 private:
  const TagPattern& pattern_;
  PictureBlur blur_;
  PrintedAxis u_, v_;
};

}  // namespace apriltrack
