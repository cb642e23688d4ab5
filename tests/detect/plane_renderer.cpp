#include "plane_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/base/random.h"

namespace apriltrack::test {
namespace {

/// Linear light to an sRGB byte (IEC 61966-2-1).
std::uint8_t encode(double light, bool is_srgb) {
  const double clamped = std::clamp(light, 0.0, 1.0);
  const double code = !is_srgb               ? clamped
                      : clamped <= 0.0031308 ? 12.92 * clamped
                                             : 1.055 * std::pow(clamped, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * code));
}

/// Where the scene is during the exposure, two instants per pixel of path.
std::vector<Eigen::Vector2d> exposure_path(const Eigen::Vector2d& motion_px) {
  const int instants = std::max(1, static_cast<int>(std::ceil(2.0 * motion_px.norm())));
  std::vector<Eigen::Vector2d> path;
  for (int i = 0; i < instants; ++i) path.emplace_back(motion_px * ((i + 0.5) / instants - 0.5));
  return path;
}

std::vector<double> gaussian_kernel(double sigma) {
  if (sigma <= 0.0) return {1.0};
  const int radius = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> kernel;
  double sum = 0.0;
  for (int i = -radius; i <= radius; ++i)
    sum += kernel.emplace_back(std::exp(-0.5 * i * i / (sigma * sigma)));
  for (double& value : kernel) value /= sum;
  return kernel;
}

Image<double> convolve_rows(const Image<double>& image, const std::vector<double>& kernel) {
  const int radius = static_cast<int>(kernel.size() / 2);
  Image<double> transposed(image.height(), image.width());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      double sum = 0.0;
      for (int i = -radius; i <= radius; ++i)
        sum +=
            kernel[static_cast<std::size_t>(i + radius)] * image(std::clamp(x + i, 0, image.width() - 1), y);
      transposed(y, x) = sum;
    }
  }
  return transposed;
}

}  // namespace

PlaneView::PlaneView(double focal_px, const Eigen::Vector2d& centre_px, double distance_m, double tilt_rad,
                     double tilt_axis_rad, double roll_rad) {
  const Eigen::Vector3d axis(std::cos(tilt_axis_rad), std::sin(tilt_axis_rad), 0.0);
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(tilt_rad, axis))
          .toRotationMatrix();
  Eigen::Matrix3d camera;
  camera << focal_px, 0.0, centre_px.x(), 0.0, focal_px, centre_px.y(), 0.0, 0.0, 1.0;
  Eigen::Matrix3d columns;
  columns << rotation.col(0), rotation.col(1), Eigen::Vector3d(0.0, 0.0, distance_m);
  pixel_from_plane_ = camera * columns;
  plane_from_pixel_ = pixel_from_plane_.inverse();
}

Eigen::Vector2d PlaneView::to_pixel(const Eigen::Vector2d& plane_m) const {
  return (pixel_from_plane_ * plane_m.homogeneous()).hnormalized();
}

Eigen::Vector2d PlaneView::to_plane(const Eigen::Vector2d& pixel) const {
  return (plane_from_pixel_ * pixel.homogeneous()).hnormalized();
}

GrayImage render_plane(int width, int height, const PlaneView& view,
                       const std::function<double(double, double)>& picture, const RenderOptions& options) {
  // Blur on a raster finer than the pixels: a kernel sampled at whole pixels is none at 0.6 px.
  const int n = options.samples;
  Image<double> fine(width * n, height * n);
  const std::vector<Eigen::Vector2d> path = exposure_path(options.motion_px);
  for (int y = 0; y < fine.height(); ++y) {
    for (int x = 0; x < fine.width(); ++x) {
      const Eigen::Vector2d pixel((x + 0.5) / n - 0.5, (y + 0.5) / n - 0.5);
      double sum = 0.0;
      for (const Eigen::Vector2d& offset : path) {
        const Eigen::Vector2d point = view.to_plane(pixel - offset);
        sum += picture(point.x(), point.y());
      }
      fine(x, y) = sum / static_cast<double>(path.size());
    }
  }
  const std::vector<double> kernel = gaussian_kernel(options.blur_sigma_px * n);
  fine = convolve_rows(convolve_rows(fine, kernel), kernel);

  RandomStream random(options.seed);
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) sum += fine(x * n + i, y * n + j);
      const double brightness = sum / (n * n);
      const double light = options.black_light + (options.white_light - options.black_light) * brightness;
      image(x, y) = encode(light + options.noise_light * random.normal(), options.is_srgb);
    }
  }
  return image;
}

}  // namespace apriltrack::test
