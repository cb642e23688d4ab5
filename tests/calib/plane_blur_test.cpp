#include "pictures/plane_blur.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "apriltrack/camera/camera_model.h"

namespace apriltrack {
namespace {

const CameraModel kBentLens({520.0, 515.0, 322.0, 238.0}, RadtanDistortion({-0.28, 0.09, 0.0005, -0.0003}));
constexpr double kHalfEdge_m = 0.08;

Pose tilted_tag() {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.9, Eigen::Vector3d(0.6, 0.8, 0.0))) *
              Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ())),
          {0.5, -0.3, 1.9}};
}

/// Where a pixel's ray meets the tag's plane, in half tag sizes.
Eigen::Vector2d on_tag(const Pose& T_camera_tag, const Eigen::Vector2d& pixel) {
  const Eigen::Vector3d ray = *kBentLens.unproject(pixel);
  const Pose T_tag_camera = T_camera_tag.inverse();
  const Eigen::Vector3d eye = T_tag_camera.translation();
  const Eigen::Vector3d direction = T_tag_camera.rotation() * ray;
  return (eye - eye.z() / direction.z() * direction).head<2>() / kHalfEdge_m;
}

/// A place of the image, smeared by sums over the lens, the pixel and the way, each point taken to the plane.
Eigen::Matrix2d smeared_place(const Pose& T_camera_tag, double psf_px, const Eigen::Vector2d& streak_px) {
  const Eigen::Vector2d centre = *kBentLens.project(T_camera_tag.translation());
  constexpr int kLens = 13, kSide = 8, kWay = 16;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  double total = 0.0;
  const auto even = [](int i, int count) { return (i + 0.5) / count - 0.5; };
  for (int a = -kLens; a <= kLens; ++a) {
    for (int b = -kLens; b <= kLens; ++b) {
      const Eigen::Vector2d in_sigmas = Eigen::Vector2d(a, b) / 3.0;
      const double weight = std::exp(-0.5 * in_sigmas.squaredNorm());
      for (int i = 0; i < kSide * kSide * kWay; ++i) {
        const Eigen::Vector2d in_pixel(even(i % kSide, kSide), even(i / kSide % kSide, kSide));
        const double way = even(i / (kSide * kSide), kWay);
        const Eigen::Vector2d at =
            on_tag(T_camera_tag, centre + psf_px * in_sigmas + in_pixel + way * streak_px);
        mean += weight * at;
        square += weight * at * at.transpose();
        total += weight;
      }
    }
  }
  mean /= total;
  return square / total - mean * mean.transpose();
}

TEST(PlaneBlur, IsWhatLensPixelAndStreakSmear) {
  const Pose pose = tilted_tag();
  for (const Eigen::Vector2d& streak_px :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(2.6, 1.1), Eigen::Vector2d(-0.7, 2.8)}) {
    const auto blur = plane_blur(kBentLens, pose, kHalfEdge_m, {0.5, streak_px});
    ASSERT_TRUE(blur.has_value());
    const Eigen::Matrix2d expected = smeared_place(pose, 0.5, streak_px);
    EXPECT_NEAR(blur->pattern.sigma_u, std::sqrt(expected(0, 0)), 0.01 * std::sqrt(expected(0, 0)));
    EXPECT_NEAR(blur->pattern.sigma_v, std::sqrt(expected(1, 1)), 0.01 * std::sqrt(expected(1, 1)));
    EXPECT_NEAR(blur->pattern.covariance_uv, expected(0, 1),
                0.02 * std::sqrt(expected(0, 0) * expected(1, 1)));
  }
}

TEST(PlaneBlur, TellsHowItFollowsTheLens) {
  const Eigen::Vector2d streak_px(2.6, 1.1);
  constexpr double kStep_px = 1e-4;
  const auto blur_of = [&](double psf_px) {
    return *plane_blur(kBentLens, tilted_tag(), kHalfEdge_m, {psf_px, streak_px});
  };
  const PlaneBlur blur = blur_of(0.6), above = blur_of(0.6 + kStep_px), below = blur_of(0.6 - kStep_px);
  const auto by_psf = [&](double more, double less) { return (more - less) / (2.0 * kStep_px); };
  const auto square = [](double sigma) { return sigma * sigma; };
  const auto& [more, less] = std::pair(above.pattern, below.pattern);
  EXPECT_NEAR(blur.covariance_by_psf(0, 0), by_psf(square(more.sigma_u), square(less.sigma_u)), 1e-6);
  EXPECT_NEAR(blur.covariance_by_psf(1, 1), by_psf(square(more.sigma_v), square(less.sigma_v)), 1e-6);
  EXPECT_NEAR(blur.covariance_by_psf(0, 1), by_psf(more.covariance_uv, less.covariance_uv), 1e-6);
}

}  // namespace
}  // namespace apriltrack
