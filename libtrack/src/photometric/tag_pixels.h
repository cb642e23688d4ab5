#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/tags/tag_corners.h"
#include "pixel_kernels.h"
#include "swept_area.h"
#include "tag_prediction.h"

namespace apriltrack {

/// The pixels that a tag is judged by, on one level: columns padded for the kernels.
struct TagPixels {
  std::vector<float> ray_x, ray_y;
  std::vector<float> image;  ///< The frame's light.
  /// 1 over a pixel's expected error, which is 1 where nothing but the tag is seen and more where the
  /// background shows: what lies behind the tag is not as even as one colour. 0 in what fills columns up.
  std::vector<float> inverse_sigma;
  std::size_t count = 0;
  double area_px = 0.0;  ///< Of level 0 that they stand for.
  int stride = 1;        ///< Every stride-th row and column.

  /// How much of the information of independent pixels these carry: neighbours err together (demosaicing,
  /// compression, the model), so that four count as one.
  double information_share() const { return std::min(1.0, 0.25 * stride * stride); }

  RayColumns rays() const { return {ray_x.data(), ray_y.data(), ray_x.size()}; }
  /// The columns that are chosen; inverse_sigma follows.
  std::array<std::vector<float>*, 4> columns() { return {&ray_x, &ray_y, &image, &inverse_sigma}; }
};

/// What a tag's pixels should show: columns as long as those of TagPixels.
struct PredictedPixels {
  std::vector<float> light, presence;
};
/// predicted: overwritten, its memory used again.
void predict(const TagPrediction& prediction, const TagPixels& pixels, PredictedPixels* predicted);

/// Pixels that the tag passes by a pixel or more during the exposure, or covers to a quarter, thinned out
/// evenly to about max_pixels: twice as many where it fills its box. Saturated pixels are left out: what
/// light they stand for is not known. predicted: what these pixels should show. Both are overwritten, and
/// their memory is used again.
void select_pixels(const PhotometricWorld& world, const LightPyramid& light, const TagPrediction& prediction,
                   const SweptArea& swept, int level, int max_pixels, TagPixels* pixels,
                   PredictedPixels* predicted);

}  // namespace apriltrack
