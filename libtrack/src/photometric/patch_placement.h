#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/image/image.h"
#include "apriltrack/photometric/patch.h"
#include "patch_kernels.h"

namespace apriltrack {

/// An image with its rows in pairs, as the patch kernels read it; row by row when they are asked for.
class RowPairs {
 public:
  /// Of another frame. Keeps its memory.
  void start(const ImageView<const float>& image);
  /// Makes pairs of rows [first, last] and of the rows between them and those made before.
  void make(int first, int last);

  PairedRows rows(double max_light) const;

 private:
  ImageView<const float> image_;
  std::vector<float> pairs_;
  int stride_ = 0;           ///< Pairs.
  int begin_ = 0, end_ = 0;  ///< Rows made.
};

/// The matrix row by row, in single precision.
std::array<float, 9> by_rows(const Eigen::Matrix3d& matrix);

LensFactors lens_factors(const CameraModel& model);

/// A patch's place in the image, and the rows of pairs that its samples need; none when last < first.
struct PlacedPatch {
  PatchPlacement placement;
  int first_row = 0, last_row = -1;
};

/// image: at least 2 x 2 pixels. camera_from_plane: as sample_patch takes it.
PlacedPatch place_patch(const ImageView<const float>& image, const CameraModel& model,
                        const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid);

}  // namespace apriltrack
