#include "swept_area.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace apriltrack {
namespace {

/// Of a side's length: what a lens bends it by, and a path by its turning.
constexpr float kBend = 0.02F;
constexpr float kMargin = 1.0F;  // pixels
constexpr double kFarthest = 1e6;

}  // namespace

SweptArea swept_area(const PhotometricWorld& world, const Image<float>& level_image, const TagSight& sight,
                     const PhotometricTag& tag, int level) {
  SweptArea area;
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < area.squares.size(); ++i) {
    std::size_t corner = 0;
    for (const auto& [u, v] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
      const Eigen::Vector3d on_plane(u * tag.half_extent, v * tag.half_extent, 1.0);
      const auto pixel = world.model.project(sight.camera_from_plane()[i] * on_plane);
      if (!pixel) return {};
      Eigen::Vector2d at(level_pixel(pixel->x(), level), level_pixel(pixel->y(), level));
      // What is nearly behind the camera may lie anywhere.
      if (at.norm() > kFarthest) at *= kFarthest / at.norm();
      box.extend(at);
      area.squares[i][corner++] = at.cast<float>();
    }
  }
  const auto inside = [](double at, int size) { return static_cast<int>(std::clamp(at, -2.0, size + 1.0)); };
  area.box.min() = {std::max(0, inside(box.min().x(), level_image.width())),
                    std::max(0, inside(box.min().y(), level_image.height()))};
  area.box.max() = {std::min(level_image.width() - 1, inside(box.max().x(), level_image.width()) + 1),
                    std::min(level_image.height() - 1, inside(box.max().y(), level_image.height()) + 1)};
  return area;
}

void SweptRows::find(const SweptArea& area) {
  first_row_ = area.box.min().y();
  constexpr float kFar = std::numeric_limits<float>::max();
  reaches_.assign(static_cast<std::size_t>(std::max(0, area.box.max().y() - first_row_ + 1)), {kFar, -kFar});
  for (const SweptArea::Square& square : area.squares) {
    for (std::size_t i = 0; i < square.size(); ++i) include(square[i], square[(i + 1) % square.size()]);
  }
  for (std::size_t instant = 1; instant < area.squares.size(); ++instant) {
    for (std::size_t i = 0; i < area.squares[instant].size(); ++i)
      include(area.squares[instant - 1][i], area.squares[instant][i]);
  }
  spans_.resize(reaches_.size());
  const auto left = static_cast<float>(area.box.min().x()), right = static_cast<float>(area.box.max().x());
  for (std::size_t i = 0; i < reaches_.size(); ++i) {
    spans_[i] = {static_cast<int>(std::max(left, std::floor(reaches_[i].least))),
                 static_cast<int>(std::min(right, std::ceil(reaches_[i].most)))};
  }
}

/// The rows that the line passes, a margin about it included.
void SweptRows::include(const Eigen::Vector2f& from, const Eigen::Vector2f& to) {
  const Eigen::Vector2f &top = from.y() <= to.y() ? from : to, &bottom = from.y() <= to.y() ? to : from;
  const Eigen::Vector2f along = bottom - top;
  const float margin = kMargin + kBend * along.norm();
  const bool is_level = along.y() < 1e-3F;
  const float slope = is_level ? 0.0F : along.x() / along.y();
  const int last_row = first_row_ + static_cast<int>(reaches_.size()) - 1;
  const int first = std::max(first_row_, static_cast<int>(std::floor(top.y() - margin)));
  const int last = std::min(last_row, static_cast<int>(std::ceil(bottom.y() + margin)));
  for (int y = first; y <= last; ++y) {
    // Of the part of the line within the margin of this row.
    const auto x_at = [&](float row) {
      return top.x() + slope * (std::clamp(row, top.y(), bottom.y()) - top.y());
    };
    const float above = is_level ? top.x() : x_at(static_cast<float>(y) - margin);
    const float below = is_level ? bottom.x() : x_at(static_cast<float>(y) + margin);
    Reach& reach = reaches_[static_cast<std::size_t>(y - first_row_)];
    reach.least = std::min({reach.least, above - margin, below - margin});
    reach.most = std::max({reach.most, above + margin, below + margin});
  }
}

}  // namespace apriltrack
