#include "pictures/plane_blur.h"

#include <Eigen/LU>
#include <cmath>

namespace apriltrack {
namespace {

constexpr double kPixelVariance = 1.0 / 12.0;  // of the light's place within its pixel
constexpr double kLeastArea_px2 = 1.0;         // of half a tag by half a tag

}  // namespace

std::optional<PlaneBlur> plane_blur(const CameraModel& camera, const Pose& T_camera_tag, double half_size_m,
                                    const ImageBlur& blur) {
  Eigen::Matrix<double, 2, 3> pixel_by_point;
  if (!camera.project(T_camera_tag.translation(), &pixel_by_point)) return std::nullopt;
  const Eigen::Matrix2d pixel_from_plane =
      half_size_m * pixel_by_point * T_camera_tag.rotation_matrix().leftCols<2>();
  if (!(std::abs(pixel_from_plane.determinant()) > kLeastArea_px2)) return std::nullopt;
  const Eigen::Matrix2d plane_from_pixel = pixel_from_plane.inverse();
  const double lens = blur.psf_sigma_px * blur.psf_sigma_px;
  Eigen::Matrix2d image = (lens + kPixelVariance) * Eigen::Matrix2d::Identity();
  image += blur.streak_px * blur.streak_px.transpose() / 12.0;
  const Eigen::Matrix2d plane = plane_from_pixel * image * plane_from_pixel.transpose();
  const Eigen::Matrix2d of_lens = plane_from_pixel * plane_from_pixel.transpose();
  return PlaneBlur{PatternBlur::of(plane), 2.0 * blur.psf_sigma_px * of_lens};
}

}  // namespace apriltrack
