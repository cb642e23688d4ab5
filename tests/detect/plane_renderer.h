#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cstdint>
#include <functional>

#include "apriltrack/image/image.h"

// The detector's truth: a picture of a plane through a pinhole, made here and nowhere else, so that a mistake
// in the simulator or in the detector cannot hide in it.

namespace apriltrack::test {

/// A plane before a pinhole camera (pixel (0, 0) = centre of the top-left pixel).
class PlaneView {
 public:
  /// Tilted by `tilt_rad` about the plane's axis at `tilt_axis_rad` from x, turned by `roll_rad` in the
  /// image, at `distance_m`, its origin seen at `centre_px`.
  PlaneView(double focal_px, const Eigen::Vector2d& centre_px, double distance_m, double tilt_rad,
            double tilt_axis_rad, double roll_rad);

  Eigen::Vector2d to_pixel(const Eigen::Vector2d& plane_m) const;
  Eigen::Vector2d to_plane(const Eigen::Vector2d& pixel) const;

 private:
  Eigen::Matrix3d pixel_from_plane_;
  Eigen::Matrix3d plane_from_pixel_;
};

struct RenderOptions {
  double black_light = 0.03;  ///< Of full scale, linear.
  double white_light = 0.75;
  double blur_sigma_px = 0.6;  ///< Of the lens, besides the pixel's own box.
  Eigen::Vector2d motion_px =
      Eigen::Vector2d::Zero();  ///< The scene's path in the image, centred on its place.
  double noise_light = 0.002;
  bool is_srgb = true;  ///< Else linear bytes.
  int samples = 4;      ///< Per pixel and axis.
  std::uint64_t seed = 1;
};

/// picture: brightness 0 to 1 of the plane at x, y in metres.
GrayImage render_plane(int width, int height, const PlaneView& view,
                       const std::function<double(double, double)>& picture, const RenderOptions& options);

}  // namespace apriltrack::test
