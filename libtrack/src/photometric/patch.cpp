#include "apriltrack/photometric/patch.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"

namespace apriltrack {

void PatchGrid::check() const {
  if (size < 3 || size > 1024) {
    throw invalid_input("patch size", fmt::format("must lie in [3, 1024] samples a side (is {})", size));
  }
  if (!(half_extent > 0.0 && half_extent <= 10.0)) {
    throw invalid_input("patch half_extent",
                        fmt::format("must lie in (0, 10] half tag sizes (is {})", half_extent));
  }
}

Eigen::Matrix3d camera_from_tag_plane(const Pose& T_camera_tag, double tag_size_m) {
  Eigen::Matrix3d M = T_camera_tag.rotation_matrix() * (0.5 * tag_size_m);
  M.col(2) = T_camera_tag.translation();
  return M;
}

std::optional<double> sample_bilinear(const ImageView<const float>& image, const Eigen::Vector2d& pixel) {
  const double x = pixel.x(), y = pixel.y();
  if (!(x >= 0.0 && y >= 0.0 && x <= image.width() - 1.0 && y <= image.height() - 1.0)) return std::nullopt;
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  // On the last row or column the neighbour beyond has no weight.
  const int x1 = std::min(x0 + 1, image.width() - 1);
  const float* top = image.row(y0);
  const float* bottom = image.row(std::min(y0 + 1, image.height() - 1));
  const double fx = x - x0, fy = y - y0;
  return (1.0 - fy) * ((1.0 - fx) * top[x0] + fx * top[x1]) +
         fy * ((1.0 - fx) * bottom[x0] + fx * bottom[x1]);
}

int sample_patch(const ImageView<const float>& image, const CameraModel& model,
                 const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid, std::span<double> samples) {
  APRILTRACK_CHECK(samples.size() == grid.num_samples(), "samples must be as many as the grid's");
  std::fill(samples.begin(), samples.end(), std::numeric_limits<double>::quiet_NaN());
  // The determinant is that of the plane's normal and centre: negative when the camera sees its back.
  if (!(camera_from_plane.determinant() > 0.0)) return 0;
  int num_seen = 0;
  std::size_t index = 0;
  for (int row = 0; row < grid.size; ++row) {
    const Eigen::Vector3d row_start =
        camera_from_plane.col(1) * grid.coordinate(row) + camera_from_plane.col(2);
    for (int column = 0; column < grid.size; ++column, ++index) {
      const Eigen::Vector3d point_camera = row_start + camera_from_plane.col(0) * grid.coordinate(column);
      const auto pixel = model.project(point_camera);
      if (!pixel) continue;
      const auto value = sample_bilinear(image, *pixel);
      if (!value) continue;
      samples[index] = *value;
      ++num_seen;
    }
  }
  return num_seen;
}

PatchMatch correlate(std::span<const double> patch, std::span<const double> reference) {
  APRILTRACK_CHECK(patch.size() == reference.size(), "patches must be of one size");
  PatchMatch match;
  double sum_a = 0.0, sum_b = 0.0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (std::isnan(patch[i]) || std::isnan(reference[i])) continue;
    sum_a += patch[i];
    sum_b += reference[i];
    ++match.num_samples;
  }
  if (match.num_samples < PatchMatch::kMinSamples) return match;
  const double mean_a = sum_a / match.num_samples, mean_b = sum_b / match.num_samples;
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (std::isnan(patch[i]) || std::isnan(reference[i])) continue;
    const double a = patch[i] - mean_a, b = reference[i] - mean_b;
    aa += a * a;
    bb += b * b;
    ab += a * b;
  }
  // What rounding leaves of a constant patch is no picture.
  constexpr double kRounding = 1e-14;
  const bool is_constant = aa <= kRounding * match.num_samples * mean_a * mean_a ||
                           bb <= kRounding * match.num_samples * mean_b * mean_b;
  if (!is_constant) match.correlation = std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
  return match;
}

}  // namespace apriltrack
