#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/tags/tag_corners.h"
#include "tag_prediction.h"

namespace apriltrack {

struct TagPixel {
  Eigen::Vector2f ray;
  float light;
  /// Its expected error, 1 where nothing but the tag is seen: what lies behind the tag is not as even as one
  /// background colour.
  float relative_sigma;
};

/// The pixels that a tag is judged by, on one level.
struct TagPixels {
  std::vector<TagPixel> pixels;
  double area_px = 0.0;  ///< Of level 0 that they stand for.
  int stride = 1;        ///< Every stride-th row and column.
};

/// The pixels of a level's image, first and last, that the printed square may pass during the exposure; empty
/// where there are none, or a corner cannot be projected.
Eigen::AlignedBox2i swept_pixels(const PhotometricWorld& world, const LightPyramid& light,
                                 const TagPrediction& prediction, const PhotometricTag& tag, int level);

/// Pixels of which the tag covers at least a quarter during the exposure, thinned out evenly to about
/// max_pixels: twice as many where it fills its box. Saturated pixels are left out: what light they stand for
/// is not known. swept: as above.
TagPixels select_pixels(const PhotometricWorld& world, const LightPyramid& light,
                        const TagPrediction& prediction, const Eigen::AlignedBox2i& swept, int level,
                        int max_pixels);

}  // namespace apriltrack
