#pragma once

#include <Eigen/Core>
#include <array>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/image/image.h"
#include "apriltrack/photometric/patch.h"
#include "patch_kernels.h"
#include "row_pairs.h"

namespace apriltrack {

/// The matrix row by row, in single precision.
std::array<float, 9> by_rows(const Eigen::Matrix3d& matrix);

LensFactors lens_factors(const CameraModel& model);

/// A patch's place in the image, and the pairs of pixels that its samples need.
struct PlacedPatch {
  PatchPlacement placement;
  PixelBox box;
};

/// image: at least 2 x 2 pixels. camera_from_plane: as sample_patch takes it.
PlacedPatch place_patch(const ImageView<const float>& image, const CameraModel& model,
                        const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid);

}  // namespace apriltrack
