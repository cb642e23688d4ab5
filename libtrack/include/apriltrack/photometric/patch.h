#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/geometry/pose.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

/// Where a tag's patch is sampled: the centres of size x size equal squares that tile
/// [-half_extent, half_extent]^2 of the tag's plane, in half tag sizes, u right, v down; row by row from the
/// top left.
///
/// The grid is symmetric. The paper's, "-1 to 1 in steps of 2 / rho", has rho + 1 points a side; its
/// program's runs from -1 + 2 / rho to 1 and so lies half a square to the right and below
/// (docs/algorithms/paper_filter.md).
struct PatchGrid {
  int size = 32;             ///< rho.
  double half_extent = 1.0;  ///< 1: the square whose corners are detected; more takes the margin in.

  std::size_t num_samples() const { return static_cast<std::size_t>(size) * static_cast<std::size_t>(size); }
  /// u of a column, v of a row.
  double coordinate(int index) const { return half_extent * ((2.0 * index + 1.0) / size - 1.0); }
  /// Throws Error(kInvalidInput) that names the field, its value and its range.
  void check() const;
};

/// Takes (u, v, 1) of the tag's plane, in half tag sizes, to a point of the camera frame.
Eigen::Matrix3d camera_from_tag_plane(const Pose& T_camera_tag, double tag_size_m);

/// Value at a place between pixel centres, from the four around it; nullopt outside the outermost pixel
/// centres. Exact for images that are linear in x and y.
std::optional<double> sample_bilinear(const ImageView<const float>& image, const Eigen::Vector2d& pixel);

/// What the image shows of a tag's patch.
///
/// camera_from_plane: (u, v, 1) to the camera frame, up to a positive factor: of camera_from_tag_plane, or
/// any homography from the plane to rays. samples: grid.num_samples() values; NaN where nothing is seen:
/// outside the image, behind the camera, beyond the lens model or beside a pixel brighter than max_light, and
/// everywhere when the tag is turned away. Returns how many are seen.
///
/// This and `correlate` define what the kernels of JointLikelihood compute.
int sample_patch(const ImageView<const float>& image, const CameraModel& model,
                 const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid, std::span<double> samples,
                 double max_light = std::numeric_limits<double>::infinity());

struct PatchMatch {
  /// Correlation coefficient (zero-mean, normalised) over the samples that both patches have; 0 when there
  /// are fewer than kMinSamples of them or one patch is constant there.
  double correlation = 0.0;
  int num_samples = 0;  ///< That both have.

  static constexpr int kMinSamples = 8;
};

/// Patches of equal length, NaN where nothing is seen. An affine change of light, positive in gain, changes
/// nothing.
PatchMatch correlate(std::span<const double> patch, std::span<const double> reference);

}  // namespace apriltrack
