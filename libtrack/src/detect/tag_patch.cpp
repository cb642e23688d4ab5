#include "apriltrack/detect/tag_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "apriltrack/detect/detection.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

/// What the lens smears, and what the corners may be off.
constexpr double kMargin_px = 4.0;

/// Of the printed cells, about the square that the corners are of.
Eigen::AlignedBox2d printed_box(const Detection& detection) {
  const TagFamily& family = TagFamily::get(detection.tag.family);
  const double extent = std::max(1.0, static_cast<double>(family.total_width()) / family.width_at_border());
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : detection.corners_px) centre += 0.25 * corner;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : detection.corners_px) box.extend(centre + extent * (corner - centre));
  return box;
}

GrayImage copy_of(const GrayView& image) {
  GrayImage copy(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), copy.row(y));
  return copy;
}

}  // namespace

std::optional<TagPatch> cut_patch(const GrayView& image, const Detection& detection) {
  for (const Eigen::Vector2d& corner : detection.corners_px) {
    if (!corner.allFinite()) return std::nullopt;
  }
  if (!TagFamily::is_known(detection.tag.family)) return std::nullopt;
  const Eigen::AlignedBox2d box = printed_box(detection);
  const auto within = [](double place, int size) {
    return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(size)));
  };
  const int x0 = within(std::floor(box.min().x() - kMargin_px), image.width());
  const int y0 = within(std::floor(box.min().y() - kMargin_px), image.height());
  const int x1 = within(std::ceil(box.max().x() + kMargin_px) + 1.0, image.width());
  const int y1 = within(std::ceil(box.max().y() + kMargin_px) + 1.0, image.height());
  if (x1 <= x0 || y1 <= y0) return std::nullopt;
  return TagPatch{detection.tag, x0, y0, copy_of(image.part({x0, y0, x1 - x0, y1 - y0}))};
}

}  // namespace apriltrack
