#include "patch_placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace apriltrack {
namespace {

/// Farther from the image's edge than the kernels' rounding.
constexpr double kEdge_px = 0.01;

/// The patch's corners in the image.
struct PatchBox {
  Eigen::AlignedBox2d box;
  bool is_in_front = true;  ///< Every corner; what lies between them then does.
};

PatchBox box_of(const Eigen::Matrix3d& pixel_from_plane, const PatchGrid& grid) {
  PatchBox found;
  for (const double u : {-grid.half_extent, grid.half_extent}) {
    for (const double v : {-grid.half_extent, grid.half_extent}) {
      const Eigen::Vector3d pixel = pixel_from_plane * Eigen::Vector3d(u, v, 1.0);
      found.is_in_front = found.is_in_front && pixel.z() > 0.0;
      found.box.extend(Eigen::Vector2d(pixel.head<2>() / pixel.z()));
    }
  }
  return found;
}

/// Limited before it is a whole number: a patch that is nearly beside the camera may lie anywhere.
int pixel_within(double pixel, int first, int last) {
  return static_cast<int>(
      std::floor(std::clamp(pixel, static_cast<double>(first), static_cast<double>(last))));
}

/// A pixel near the patch's centre with neighbours to the right and below.
Eigen::Vector2i base_of(const ImageView<const float>& image, const CameraModel& model,
                        const Eigen::Vector3d& centre_camera) {
  const Eigen::Vector2d centre =
      model.project(centre_camera).value_or(Eigen::Vector2d(0.5 * image.width(), 0.5 * image.height()));
  return {pixel_within(centre.x(), 0, image.width() - 2), pixel_within(centre.y(), 0, image.height() - 2)};
}

void place_pinhole(const ImageView<const float>& image, const Pinhole& pinhole,
                   const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid, PlacedPatch* placed) {
  PatchPlacement& placement = placed->placement;
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K << pinhole.fx, 0.0, pinhole.cx - placement.base_x, 0.0, pinhole.fy, pinhole.cy - placement.base_y, 0.0,
      0.0, 1.0;
  const Eigen::Matrix3d pixel_from_plane = K * camera_from_plane;
  placement.from_plane = by_rows(pixel_from_plane);
  const auto [box, is_in_front] = box_of(pixel_from_plane, grid);
  if (!is_in_front) return;
  const Eigen::Vector2d base(placement.base_x, placement.base_y);
  const Eigen::AlignedBox2d whole(
      Eigen::Vector2d(kEdge_px, kEdge_px) - base,
      Eigen::Vector2d(image.width() - 1 - kEdge_px, image.height() - 1 - kEdge_px) - base);
  placement.is_inside = whole.contains(box);
  const Eigen::Vector2d first = box.min() + base, last = box.max() + base;
  // The pixel to the right of a place is in the next pair, the one below in the same.
  placed->box = {
      pixel_within(first.x() - 1.0, 0, image.width()), pixel_within(last.x() + 2.0, -1, image.width() - 1),
      pixel_within(first.y() - 1.0, 0, image.height()), pixel_within(last.y() + 1.0, -1, image.height() - 2)};
}

}  // namespace

std::array<float, 9> by_rows(const Eigen::Matrix3d& matrix) {
  std::array<float, 9> values{};
  for (int i = 0; i < 9; ++i) values[static_cast<std::size_t>(i)] = static_cast<float>(matrix(i / 3, i % 3));
  return values;
}

LensFactors lens_factors(const CameraModel& model) {
  LensFactors factors;
  factors.fx = static_cast<float>(model.pinhole().fx);
  factors.fy = static_cast<float>(model.pinhole().fy);
  const auto take = [&](const std::vector<double>& coefficients) {
    std::ranges::transform(coefficients, factors.coefficients.begin(),
                           [](double value) { return static_cast<float>(value); });
  };
  if (const auto* radtan = std::get_if<RadtanDistortion>(&model.distortion())) {
    factors.kind = LensKind::kRadtan;
    factors.limit = static_cast<float>(radtan->max_radius() * radtan->max_radius());
    take(radtan->coefficients());
  } else if (const auto* equidistant = std::get_if<EquidistantDistortion>(&model.distortion())) {
    factors.kind = LensKind::kEquidistant;
    factors.limit = static_cast<float>(equidistant->max_angle_rad());
    take(equidistant->coefficients());
  }
  return factors;
}

PlacedPatch place_patch(const ImageView<const float>& image, const CameraModel& model,
                        const Eigen::Matrix3d& camera_from_plane, const PatchGrid& grid) {
  PlacedPatch placed;
  const Eigen::Vector2i base = base_of(image, model, camera_from_plane.col(2));
  PatchPlacement& placement = placed.placement;
  placement.base_x = base.x();
  placement.base_y = base.y();
  placement.origin_light = image(base.x(), base.y());
  // Where a bound would be dear, all.
  placed.box = {0, image.width() - 1, 0, image.height() - 2};
  if (std::holds_alternative<NoDistortion>(model.distortion())) {
    place_pinhole(image, model.pinhole(), camera_from_plane, grid, &placed);
    return placed;
  }
  placement.from_plane = by_rows(camera_from_plane);
  placement.offset_x = static_cast<float>(model.pinhole().cx - base.x());
  placement.offset_y = static_cast<float>(model.pinhole().cy - base.y());
  return placed;
}

}  // namespace apriltrack
