#include "tag_prediction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "apriltrack/geometry/tag_view.h"
#include "apriltrack/photometric/patch.h"
#include "view_cone.h"

namespace apriltrack {
namespace {

constexpr double kMinCosine = 0.14;  ///< 82 degrees: beyond, a tag is a line.
constexpr int kMaxInstants = 16;
constexpr double kInstantSpacing = 1.2;  ///< Pixels of the level.

bool faces_camera(const Pose& T_camera_tag, double half_size_m) {
  return T_camera_tag.translation().z() > half_size_m && tag_view_cosine(T_camera_tag) > kMinCosine;
}

/// Where the point is in a plain pinhole image, pixels.
Eigen::Vector2d pinhole(const Eigen::Vector3d& point, double focal_px) {
  return focal_px * point.head<2>() / std::max(1e-6, point.z());
}

}  // namespace

TagPrediction::TagPrediction(PhotometricWorld& world, PhotometricTag& tag, const MotionState& state,
                             double exposure_s, int level, double extra_sigma_px) {
  const double focal_px = world.focal_px();
  const double half_size = tag.half_size_m();
  const auto view_at = [&](double time_s) {
    return camera_from_map(pose_after(state, time_s), world.mode) * tag.tag.T_map_tag;
  };
  T_camera_tag_ = view_at(0.0);
  path_ = {view_at(-0.5 * exposure_s), view_at(0.5 * exposure_s)};
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
  const int count = static_cast<int>(std::clamp(needed, 1.0, static_cast<double>(kMaxInstants)));
  for (int m = 0; m < count; ++m) {
    const double time_s = exposure_s * ((m + 0.5) / count - 0.5);
    const Eigen::Matrix3d H =
        camera_from_tag_plane(count == 1 ? T_camera_tag_ : view_at(time_s), tag.tag.size_m);
    const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> N = H.inverse().cast<float>();
    Instant instant;
    std::copy_n(N.data(), 9, instant.plane_from_ray.begin());
    instant.time_s = static_cast<float>(time_s);
    instants_.push_back(instant);
  }

  // What blurs a single instant, as a covariance in pixels, seen from the tag's plane at its centre.
  const double isotropic = world.psf_sigma_px * world.psf_sigma_px + level_pixel * level_pixel / 12.0 +
                           extra_sigma_px * extra_sigma_px;
  Eigen::Matrix2d blur = isotropic * Eigen::Matrix2d::Identity();
  blur += streak * streak.transpose() / (12.0 * count * count);
  const Eigen::Matrix3d H = camera_from_tag_plane(T_camera_tag_, tag.tag.size_m);
  const Eigen::Vector3d& centre = T_camera_tag_.translation();
  Eigen::Matrix2d pixel_from_plane;
  for (int k = 0; k < 2; ++k)
    pixel_from_plane.col(k) =
        focal_px * (H.col(k).head<2>() - H(2, k) / centre.z() * centre.head<2>()) / centre.z();
  const Eigen::Matrix2d plane_from_pixel = pixel_from_plane.inverse();
  const Eigen::Matrix2d in_plane = plane_from_pixel * blur * plane_from_pixel.transpose();
  texture_ = world.textures.blurred(tag.index, std::sqrt(in_plane(0, 0)), std::sqrt(in_plane(1, 1)));
}

PixelPrediction TagPrediction::predict(const Eigen::Vector2f& ray) const {
  PixelPrediction sum;
  for (const Instant& instant : instants_) {
    const PlanePoint point = instant.meet(ray);
    if (!(point.depth > 0.0F)) continue;
    const PatternSample sample = texture_->sample(point.u, point.v);
    sum.light += sample.light;
    sum.presence += sample.presence;
  }
  const float share = 1.0F / static_cast<float>(instants_.size());
  return {sum.light * share, sum.presence * share};
}

PixelPrediction TagPrediction::predict(const Eigen::Vector2f& ray, PixelJacobian& jacobian) const {
  PixelPrediction sum;
  jacobian = {};
  const float share = 1.0F / static_cast<float>(instants_.size());
  for (const Instant& instant : instants_) {
    const PlanePoint point = instant.meet(ray);
    if (!(point.depth > 0.0F)) continue;
    PatternGradient gradient;
    const PatternSample sample = texture_->sample(point.u, point.v, gradient);
    sum.light += sample.light * share;
    sum.presence += sample.presence * share;
    // Moving the plane by dp where the ray meets it moves the place met by -(N_u - u N_w) dp.
    const float* N = instant.plane_from_ray.data();
    float du[3], dv[3];
    for (int k = 0; k < 3; ++k) {
      du[k] = share * (point.u * N[6 + k] - N[k]);
      dv[k] = share * (point.v * N[6 + k] - N[3 + k]);
    }
    const float at[3] = {point.depth * ray.x(), point.depth * ray.y(), point.depth};
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
