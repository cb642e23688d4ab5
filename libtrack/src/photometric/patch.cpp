#include "apriltrack/photometric/patch.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

constexpr double kOutside = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// sample_bilinear, with NaN for "not seen".
double bilinear_or_nan(const ImageView<const float>& image, double x, double y, double max_light) {
  if (!(x >= 0.0 && y >= 0.0 && x <= image.width() - 1.0 && y <= image.height() - 1.0)) return kOutside;
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  // On the last row or column the neighbour beyond has no weight.
  const int x1 = std::min(x0 + 1, image.width() - 1);
  const float* top = image.row(y0);
  const float* bottom = image.row(std::min(y0 + 1, image.height() - 1));
  const double fx = x - x0, fy = y - y0;
  const float brightest = std::max({top[x0], top[x1], bottom[x0], bottom[x1]});
  if (static_cast<double>(brightest) > max_light) return kOutside;
  return (1.0 - fy) * ((1.0 - fx) * top[x0] + fx * top[x1]) +
         fy * ((1.0 - fx) * bottom[x0] + fx * bottom[x1]);
}

/// project: pixel of matrix * (u, v, 1), NaN where there is none.
template <class Project>
int sample_grid(const ImageView<const float>& image, const Eigen::Matrix3d& matrix, const PatchGrid& grid,
                std::span<double> samples, double max_light, const Project& project) {
  int num_seen = 0;
  std::size_t index = 0;
  for (int row = 0; row < grid.size; ++row) {
    const Eigen::Vector3d row_start = matrix.col(1) * grid.coordinate(row) + matrix.col(2);
    for (int column = 0; column < grid.size; ++column, ++index) {
      const Eigen::Vector2d pixel = project(row_start + matrix.col(0) * grid.coordinate(column));
      samples[index] = bilinear_or_nan(image, pixel.x(), pixel.y(), max_light);
      num_seen += std::isnan(samples[index]) ? 0 : 1;
    }
  }
  return num_seen;
}

}  // namespace

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
  const double value = bilinear_or_nan(image, pixel.x(), pixel.y(), kNoLimit);
  if (std::isnan(value)) return std::nullopt;
  return value;
}

int sample_patch(const ImageView<const float>& image, const CameraModel& model,
                 const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid, std::span<double> samples,
                 double max_light) {
  APRILTRACK_CHECK(samples.size() == grid.num_samples(), "samples must be as many as the grid's");
  // The determinant is that of the plane's normal and centre: negative when the camera sees its back.
  if (!(camera_from_plane.determinant() > 0.0)) {
    std::fill(samples.begin(), samples.end(), kOutside);
    return 0;
  }
  const Eigen::Vector2d nowhere(kOutside, kOutside);
  if (std::holds_alternative<NoDistortion>(model.distortion())) {
    // A plain pinhole is a homography: four times faster than the general way, which serves all lenses.
    const Pinhole& pinhole = model.pinhole();
    Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
    K << pinhole.fx, 0.0, pinhole.cx, 0.0, pinhole.fy, pinhole.cy, 0.0, 0.0, 1.0;
    return sample_grid(image, K * camera_from_plane, grid, samples, max_light,
                       [&](const Eigen::Vector3d& pixel) {
                         return pixel.z() > 0.0 ? Eigen::Vector2d(pixel.head<2>() / pixel.z()) : nowhere;
                       });
  }
  return sample_grid(
      image, camera_from_plane, grid, samples, max_light,
      [&](const Eigen::Vector3d& point_camera) { return model.project(point_camera).value_or(nowhere); });
}

PatchMatch correlate(std::span<const double> patch, std::span<const double> reference) {
  APRILTRACK_CHECK(patch.size() == reference.size(), "patches must be of one size");
  PatchMatch match;
  // Sums about the first common sample: in one pass, and without the cancellation of sums about zero.
  double origin_a = 0.0, origin_b = 0.0;
  double sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (std::isnan(patch[i]) || std::isnan(reference[i])) continue;
    if (match.num_samples++ == 0) {
      origin_a = patch[i];
      origin_b = reference[i];
    }
    const double a = patch[i] - origin_a, b = reference[i] - origin_b;
    sum_a += a;
    sum_b += b;
    sum_aa += a * a;
    sum_bb += b * b;
    sum_ab += a * b;
  }
  if (match.num_samples < PatchMatch::kMinSamples) return match;
  const double n = match.num_samples;
  const double aa = sum_aa - sum_a * sum_a / n;
  const double bb = sum_bb - sum_b * sum_b / n;
  const double ab = sum_ab - sum_a * sum_b / n;
  // What rounding leaves of a constant patch is no picture.
  constexpr double kRounding = 1e-12;
  const bool is_constant = !(aa > kRounding * sum_aa && bb > kRounding * sum_bb);
  if (!is_constant) match.correlation = std::clamp(ab / std::sqrt(aa * bb), -1.0, 1.0);
  return match;
}

}  // namespace apriltrack
