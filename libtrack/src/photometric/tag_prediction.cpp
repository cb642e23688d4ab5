#include "tag_prediction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "view_cone.h"

namespace apriltrack {
namespace {

constexpr double kMinCosine = 0.14;  ///< 82 degrees: beyond, a tag is a line.
/// Pixels of the level: finest where the answer is made.
constexpr double kInstantSpacing = 1.2, kInstantSpacingCoarse = 2.0;

bool faces_camera(const PhotometricTag& tag, const MapView& view, const Eigen::Vector3d& centre) {
  return centre.z() > tag.half_size_m() &&
         (view.rotation * tag.normal_map).dot(centre) > kMinCosine * centre.norm();
}

/// Where the point is in a plain pinhole image, pixels.
Eigen::Vector2d pinhole(const Eigen::Vector3d& point, double focal_px) {
  return focal_px * point.head<2>() / std::max(1e-6, point.z());
}

/// The longest way of a tag's corner from the one view to the other, pixels of level 0.
Eigen::Vector2d longest_streak(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to, double focal_px) {
  Eigen::Vector2d longest = Eigen::Vector2d::Zero();
  for (const double u : {-1.0, 1.0}) {
    for (const double v : {-1.0, 1.0}) {
      const Eigen::Vector3d corner(u, v, 1.0);
      const Eigen::Vector2d move = pinhole(to * corner, focal_px) - pinhole(from * corner, focal_px);
      if (move.squaredNorm() > longest.squaredNorm()) longest = move;
    }
  }
  return longest;
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

TagSight::TagSight(const PhotometricWorld& world, const PhotometricTag& tag, const ViewPath& path) {
  bool may_be_seen = false;
  const std::array views = {&path.opening(), &path.middle(), &path.closing()};
  for (std::size_t i = 0; i < views.size(); ++i) {
    camera_from_plane_[i] = views[i]->of_plane(tag.map_from_plane);
    const Eigen::Vector3d centre = camera_from_plane_[i].col(2);
    if (!faces_camera(tag, *views[i], centre)) return;
    may_be_seen = may_be_seen || may_be_in_view(centre, tag.radius_m(), world.max_view_angle_rad);
  }
  is_visible_ = may_be_seen;
}

TagPrediction::TagPrediction(PhotometricWorld& world, const PhotometricTag& tag, ViewPath& path, int level,
                             double extra_sigma_px)
    : TagPrediction(world, tag, TagSight(world, tag, path), path, level, extra_sigma_px) {}

TagPrediction::TagPrediction(PhotometricWorld& world, const PhotometricTag& tag, const TagSight& sight,
                             ViewPath& path, int level, double extra_sigma_px)
    : TagSight(sight) {
  if (!is_visible()) return;
  const double focal_px = world.focal_px();
  const Eigen::Vector2d streak = longest_streak(camera_from_plane()[0], camera_from_plane()[2], focal_px);
  path_px_ = streak.norm();
  const double level_pixel = 1 << level;
  const std::span<const MapView> instants =
      path.instants(path_px_ / ((level == 0 ? kInstantSpacing : kInstantSpacingCoarse) * level_pixel));
  const double isotropic = world.psf_sigma_px * world.psf_sigma_px + level_pixel * level_pixel / 12.0 +
                           extra_sigma_px * extra_sigma_px;
  Eigen::Matrix2d blur_px2 = isotropic * Eigen::Matrix2d::Identity();
  const auto count = static_cast<double>(instants.size());
  blur_px2 += streak * streak.transpose() / (12.0 * count * count);
  const Eigen::Matrix2d blur = in_plane(blur_px2, camera_from_plane()[1], focal_px);
  texture_ = world.textures.blurred(tag.index, std::sqrt(blur(0, 0)), std::sqrt(blur(1, 1)));
  set_instants(tag, instants);
}

void TagPrediction::set_instants(const PhotometricTag& tag, std::span<const MapView> views) {
  const TexelGrid grid = texture_->grid();
  Eigen::Matrix3d texel_from_plane = Eigen::Matrix3d::Identity();
  texel_from_plane(0, 0) = static_cast<double>(grid.columns_per_unit);
  texel_from_plane(1, 1) = static_cast<double>(grid.rows_per_unit);
  texel_from_plane(0, 2) = texel_from_plane(0, 0) * static_cast<double>(grid.half_width);
  texel_from_plane(1, 2) = texel_from_plane(1, 1) * static_cast<double>(grid.half_height);
  num_instants_ = views.size();
  for (std::size_t m = 0; m < num_instants_; ++m) {
    const Eigen::Matrix3d H = views[m].of_plane(tag.map_from_plane);
    const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> N = (texel_from_plane * H.inverse()).cast<float>();
    std::copy_n(N.data(), 9, instants_[m].texel_from_ray.begin());
    instants_[m].time_s = static_cast<float>(views[m].time_s);
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
