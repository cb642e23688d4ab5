#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/tag_patch.h"
#include "apriltrack/tags/tag_family.h"
#include "pictures/plane_blur.h"
#include "pictures/tag_light.h"

namespace apriltrack {

/// A tag as it is printed.
struct PrintedTag {
  TagPattern pattern;
  double half_size_m = 0.0;
};

/// The pixels of one tag in one image, in linear light.
struct PhotometricView {
  int tag = 0;     ///< Into the map's tags.
  int moment = 0;  ///< Into the poses of the rig.
  int camera = 0;  ///< Into the rig.
  Eigen::Vector2d streak_px = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> rays = {};  ///< Of the pixels, as (x / z, y / z).
  std::vector<double> light = {};
  /// Of the pixels, the first so many are every other one of every other row.
  std::size_t num_coarse = 0;
};

/// Which pixels of a view are asked.
enum class Pixels { kAll, kCoarse };

/// Reads a patch's pixels into `view`: those that show printed cells and nothing else. Saturated ones are
/// left out, and those about them, for how white the white is there nobody knows. False where too few are
/// left.
bool read_pixels(const TagPatch& patch, const Camera& camera, const PrintedTag& tag, const Pose& T_camera_tag,
                 double psf_sigma_px, PhotometricView& view);

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// Gauss and Newton's equations of one view's pixels, in [left perturbation of T_camera_tag; sigma of the
/// lens blur in px]: brightness, contrast and the light's slope across the tag are eliminated.
struct ViewEquations {
  Matrix7d H = Matrix7d::Zero();
  Vector7d g = Vector7d::Zero();
  double correlation = 0.0;  ///< sqrt of the share of the pixels' variance that the picture explains.
};

/// light: of the tag. sums: of that light, added to. nullopt where the tag is not seen as it should be. Of
/// views with few pixels all are asked.
std::optional<ViewEquations> view_equations(const PhotometricView& view, const CameraModel& camera,
                                            const PrintedTag& tag, const Pose& T_camera_tag,
                                            double psf_sigma_px, const TagLight& light, TagLight::Sums& sums,
                                            Pixels pixels = Pixels::kAll);

}  // namespace apriltrack
