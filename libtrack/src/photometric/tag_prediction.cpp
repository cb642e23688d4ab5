#include "tag_prediction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "apriltrack/geometry/tag_view.h"
#include "apriltrack/photometric/patch.h"
#include "view_cone.h"

namespace apriltrack {
namespace {

constexpr double kMinCosine = 0.14;      ///< 82 degrees: beyond, a tag is a line.
constexpr double kInstantSpacing = 1.2;  ///< Pixels of the level.

bool faces_camera(const Pose& T_camera_tag, double half_size_m) {
  return T_camera_tag.translation().z() > half_size_m && tag_view_cosine(T_camera_tag) > kMinCosine;
}

/// Where the point is in a plain pinhole image, pixels.
Eigen::Vector2d pinhole(const Eigen::Vector3d& point, double focal_px) {
  return focal_px * point.head<2>() / std::max(1e-6, point.z());
}

/// T_camera_tag, `time_s` after the middle of the exposure.
Pose view_of(const PhotometricWorld& world, const PhotometricTag& tag, const MotionState& state,
             double time_s) {
  return camera_from_map(pose_after(state, time_s), world.mode) * tag.tag.T_map_tag;
}

/// What an instant shows is blurred by `blur_px2` in the image: its covariance in the tag's plane, in half
/// tag sizes, at the tag's centre.
Eigen::Matrix2d in_plane(const Eigen::Matrix2d& blur_px2, const Eigen::Matrix3d& camera_from_plane,
                         double focal_px) {
  const Eigen::Matrix3d& H = camera_from_plane;
  Eigen::Matrix2d pixel_from_plane;
  for (int k = 0; k < 2; ++k)
    pixel_from_plane.col(k) =
        focal_px * (H.col(k).head<2>() - H(2, k) / H(2, 2) * H.col(2).head<2>()) / H(2, 2);
  const Eigen::Matrix2d plane_from_pixel = pixel_from_plane.inverse();
  return plane_from_pixel * blur_px2 * plane_from_pixel.transpose();
}

}  // namespace

TagPrediction::TagPrediction(PhotometricWorld& world, PhotometricTag& tag, const MotionState& state,
                             double exposure_s, int level, double extra_sigma_px) {
  const double focal_px = world.focal_px();
  const double half_size = tag.half_size_m();
  T_camera_tag_ = view_of(world, tag, state, 0.0);
  path_ = {view_of(world, tag, state, -0.5 * exposure_s), view_of(world, tag, state, 0.5 * exposure_s)};
  const std::array views = {path_[0], T_camera_tag_, path_[1]};
  is_visible_ = std::ranges::all_of(views, [&](const Pose& view) { return faces_camera(view, half_size); }) &&
                std::ranges::any_of(views, [&](const Pose& view) {
                  return may_be_in_view(view.translation(), tag.radius_m(), world.max_view_angle_rad);
                });
  if (!is_visible_) return;

  Eigen::Vector2d streak = Eigen::Vector2d::Zero();  // the longest of the corners', pixels of level 0
  for (const Eigen::Vector3d& corner : tag_corners(tag.tag.size_m)) {
    const Eigen::Vector2d move = pinhole(path_[1] * corner, focal_px) - pinhole(path_[0] * corner, focal_px);
    if (move.squaredNorm() > streak.squaredNorm()) streak = move;
  }
  path_px_ = streak.norm();
  const double level_pixel = 1 << level;
  // Limited before it is a whole number: a path that ends beside the camera is as long as it likes.
  const double needed = std::ceil(path_px_ / (kInstantSpacing * level_pixel));
  num_instants_ = static_cast<int>(std::clamp(needed, 1.0, static_cast<double>(kMaxInstants)));

  const double isotropic = world.psf_sigma_px * world.psf_sigma_px + level_pixel * level_pixel / 12.0 +
                           extra_sigma_px * extra_sigma_px;
  Eigen::Matrix2d blur_px2 = isotropic * Eigen::Matrix2d::Identity();
  blur_px2 += streak * streak.transpose() / (12.0 * num_instants_ * num_instants_);
  const Eigen::Matrix2d blur =
      in_plane(blur_px2, camera_from_tag_plane(T_camera_tag_, tag.tag.size_m), focal_px);
  texture_ = world.textures.blurred(tag.index, std::sqrt(blur(0, 0)), std::sqrt(blur(1, 1)));
  set_instants(world, tag, state, exposure_s);
}

void TagPrediction::set_instants(const PhotometricWorld& world, const PhotometricTag& tag,
                                 const MotionState& state, double exposure_s) {
  const TexelGrid grid = texture_->grid();
  Eigen::Matrix3d texel_from_plane = Eigen::Matrix3d::Identity();
  texel_from_plane(0, 0) = static_cast<double>(grid.columns_per_unit);
  texel_from_plane(1, 1) = static_cast<double>(grid.rows_per_unit);
  texel_from_plane(0, 2) = texel_from_plane(0, 0) * static_cast<double>(grid.half_width);
  texel_from_plane(1, 2) = texel_from_plane(1, 1) * static_cast<double>(grid.half_height);
  for (int m = 0; m < num_instants_; ++m) {
    const double time_s = exposure_s * ((m + 0.5) / num_instants_ - 0.5);
    const Eigen::Matrix3d H = camera_from_tag_plane(
        num_instants_ == 1 ? T_camera_tag_ : view_of(world, tag, state, time_s), tag.tag.size_m);
    const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> N = (texel_from_plane * H.inverse()).cast<float>();
    TexelInstant& instant = instants_[static_cast<std::size_t>(m)];
    std::copy_n(N.data(), 9, instant.texel_from_ray.begin());
    instant.time_s = static_cast<float>(time_s);
  }
}

namespace {

/// Where a ray meets the tag's plane, in texels; depth in metres, not positive behind the camera.
struct TexelPlace {
  float column, row, depth;
};

TexelPlace meet(const TexelInstant& instant, const Eigen::Vector2f& ray) {
  const float* N = instant.texel_from_ray.data();
  const float depth = 1.0F / (N[6] * ray.x() + N[7] * ray.y() + N[8]);
  return {depth * (N[0] * ray.x() + N[1] * ray.y() + N[2]), depth * (N[3] * ray.x() + N[4] * ray.y() + N[5]),
          depth};
}

}  // namespace

PixelPrediction TagPrediction::predict(const Eigen::Vector2f& ray) const {
  PixelPrediction sum;
  for (const TexelInstant& instant : texel_path().instants) {
    const TexelPlace place = meet(instant, ray);
    if (!(place.depth > 0.0F)) continue;
    const PatternSample sample = texture_->sample_texels(place.column, place.row);
    sum.light += sample.light;
    sum.presence += sample.presence;
  }
  const float share = 1.0F / static_cast<float>(num_instants_);
  return {sum.light * share, sum.presence * share};
}

PixelPrediction TagPrediction::predict(const Eigen::Vector2f& ray, PixelJacobian& jacobian) const {
  PixelPrediction sum;
  jacobian = {};
  const float share = 1.0F / static_cast<float>(num_instants_);
  for (const TexelInstant& instant : texel_path().instants) {
    const TexelPlace place = meet(instant, ray);
    if (!(place.depth > 0.0F)) continue;
    PatternGradient gradient;
    const PatternSample sample = texture_->sample_texels(place.column, place.row, &gradient);
    sum.light += sample.light * share;
    sum.presence += sample.presence * share;
    // Moving the plane by dp where the ray meets it moves the texel met by -(N_u - column N_w) dp.
    const float* N = instant.texel_from_ray.data();
    float du[3], dv[3];
    for (int k = 0; k < 3; ++k) {
      du[k] = share * (place.column * N[6 + k] - N[k]);
      dv[k] = share * (place.row * N[6 + k] - N[3 + k]);
    }
    const float at[3] = {place.depth * ray.x(), place.depth * ray.y(), place.depth};
    const auto add = [&](float by_u, float by_v, std::array<float, 6>& by_pose,
                         std::array<float, 6>& by_rate) {
      float step[6];
      for (int k = 0; k < 3; ++k) step[k] = by_u * du[k] + by_v * dv[k];
      step[3] = at[1] * step[2] - at[2] * step[1];
      step[4] = at[2] * step[0] - at[0] * step[2];
      step[5] = at[0] * step[1] - at[1] * step[0];
      for (std::size_t k = 0; k < 6; ++k) {
        by_pose[k] += step[k];
        by_rate[k] += instant.time_s * step[k];
      }
    };
    add(gradient.light_u, gradient.light_v, jacobian.light_by_pose, jacobian.light_by_rate);
    add(gradient.presence_u, gradient.presence_v, jacobian.presence_by_pose, jacobian.presence_by_rate);
  }
  return sum;
}

}  // namespace apriltrack
