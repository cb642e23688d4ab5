#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"
#include "pixel_kernels.h"
#include "view_path.h"

namespace apriltrack {

/// What a pixel shows of a tag during the exposure: the mean over its instants.
struct PixelPrediction {
  float light = 0.0F;
  float presence = 0.0F;
};

/// The same with derivatives with respect to [translation; rotation] of a LEFT perturbation of the camera's
/// view of the map, and to its rate.
struct PixelJacobian {
  std::array<float, 6> light_by_pose{}, presence_by_pose{}, light_by_rate{}, presence_by_rate{};
};

/// Where a path puts a tag, and whether it may be seen there.
class TagSight {
 public:
  TagSight(const PhotometricWorld& world, const PhotometricTag& tag, const ViewPath& path);

  /// Whether the tag faces the camera, in front of it, during the whole exposure, and may be in the image.
  bool is_visible() const { return is_visible_; }
  /// From (u, v, 1) of the tag's plane, in half tag sizes, to the camera frame: when the shutter opens, in
  /// the middle, and when it closes.
  const std::array<Eigen::Matrix3d, 3>& camera_from_plane() const { return camera_from_plane_; }

 private:
  std::array<Eigen::Matrix3d, 3> camera_from_plane_;
  bool is_visible_ = false;
};

/// One tag seen along one path: the exposure integral of its pattern for any pixel.
///
/// A pixel's ray meets the tag's plane at another place at every instant; the pixel's light is the mean of
/// the pattern there (docs/algorithms/blur_tracker.md, equation 2). Instants are at most 1.2 pixels of the
/// level apart where the limit allows; what lies between them, the lens and the pixel's own area blur the
/// pattern beforehand.
class TagPrediction : public TagSight {
 public:
  /// extra_sigma_px: further blur, pixels of level 0, to see a tag from further off.
  TagPrediction(PhotometricWorld& world, const PhotometricTag& tag, ViewPath& path, int level,
                double extra_sigma_px = 0.0);
  /// sight: of the tag, on the path.
  TagPrediction(PhotometricWorld& world, const PhotometricTag& tag, const TagSight& sight, ViewPath& path,
                int level, double extra_sigma_px);

  std::size_t num_instants() const { return num_instants_; }
  double path_px() const { return path_px_; }
  /// What every instant shows: the pattern under the blur of an instant. Requires is_visible().
  const PatternTexture& texture() const { return *texture_; }

  /// What the kernels ask for. Requires is_visible().
  TexelPath texel_path() const { return {texture_->grid(), std::span(instants_).first(num_instants_)}; }

  /// ray: (x / z, y / z). The definition of what predict_pixels and linearise_pixels compute.
  PixelPrediction predict(const Eigen::Vector2f& ray) const;
  PixelPrediction predict(const Eigen::Vector2f& ray, PixelJacobian& jacobian) const;

 private:
  void set_instants(const PhotometricTag& tag, std::span<const MapView> views);

  std::array<TexelInstant, ViewPath::kMaxInstants> instants_;
  std::size_t num_instants_ = 0;
  std::shared_ptr<const PatternTexture> texture_;
  double path_px_ = 0.0;
};

}  // namespace apriltrack
