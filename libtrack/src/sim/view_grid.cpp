#include "view_grid.h"

#include <algorithm>

namespace apriltrack {
namespace {

constexpr double kSteepestRay =
    0.05;  // z of a unit ray: x/z stays a useful number up to 87 degrees off the axis

void include(RayBounds& bounds, float x, float y) {
  bounds.min_x = std::min(bounds.min_x, x);
  bounds.max_x = std::max(bounds.max_x, x);
  bounds.min_y = std::min(bounds.min_y, y);
  bounds.max_y = std::max(bounds.max_y, y);
}

}  // namespace

ViewGrid::ViewGrid(const Camera& camera)
    : ray_x_(camera.width, camera.height),
      ray_y_(camera.width, camera.height),
      is_seen_(camera.width, camera.height) {
  trace_pixels(camera.model);
  for (int y = 0; y < height(); y += kTileHeight) {
    for (int x = 0; x < width(); x += kTileWidth) make_tile(x, y);
  }
}

void ViewGrid::trace_pixels(const CameraModel& model) {
  for (int y = 0; y < height(); ++y) {
    for (int x = 0; x < width(); ++x) {
      const auto ray = model.unproject({x, y});
      if (!ray || (*ray).z() < kSteepestRay) {
        sees_everywhere_ = false;
        continue;
      }
      ray_x_(x, y) = static_cast<float>((*ray).x() / (*ray).z());
      ray_y_(x, y) = static_cast<float>((*ray).y() / (*ray).z());
      is_seen_(x, y) = 1;
    }
  }
}

void ViewGrid::look(const Tile& tile, const Eigen::Vector2f& offset_px, TileLook& out) const {
  const Eigen::Vector2f aside = tile.ray_per_px * offset_px;
  out.tile = tile;
  out.tile.bounds.min_x += aside.x();
  out.tile.bounds.max_x += aside.x();
  out.tile.bounds.min_y += aside.y();
  out.tile.bounds.max_y += aside.y();
  out.tile.centre += aside;
  for (Eigen::Vector2f& corner : out.tile.corners) corner += aside;
  for (int y = 0; y < tile.height; ++y) {
    const float* row_x = ray_x_.row(tile.y + y) + tile.x;
    const float* row_y = ray_y_.row(tile.y + y) + tile.x;
    for (int x = 0; x < tile.width; ++x) {
      out.rays_x[y * kTileWidth + x] = row_x[x] + aside.x();
      out.rays_y[y * kTileWidth + x] = row_y[x] + aside.y();
    }
  }
}

void ViewGrid::make_tile(int x, int y) {
  Tile tile{.x = x,
            .y = y,
            .width = std::min(kTileWidth, width() - x),
            .height = std::min(kTileHeight, height() - y)};
  const int right = x + tile.width - 1;
  const int bottom = y + tile.height - 1;
  bool is_started = false;
  for (int v = y; v <= bottom; ++v) {
    for (int u = x; u <= right; ++u) {
      if (!is_seen(u, v)) continue;
      const float ray_x = ray_x_(u, v);
      const float ray_y = ray_y_(u, v);
      if (!is_started) tile.bounds = {ray_x, ray_x, ray_y, ray_y};
      is_started = true;
      include(tile.bounds, ray_x, ray_y);
    }
  }
  if (!is_started) return;

  const auto ray = [&](int u, int v) { return Eigen::Vector2f(ray_x_(u, v), ray_y_(u, v)); };
  tile.corners = {ray(x, y), ray(right, y), ray(right, bottom), ray(x, bottom)};
  const int u_0 = std::min(x, width() - 2), u_1 = std::max(right, u_0 + 1);
  const int v_0 = std::min(y, height() - 2), v_1 = std::max(bottom, v_0 + 1);
  const int mid_u = (u_0 + u_1) / 2;
  const int mid_v = (v_0 + v_1) / 2;
  tile.centre = ray(mid_u, mid_v);
  tile.ray_per_px.col(0) = (ray(u_1, mid_v) - ray(u_0, mid_v)) / static_cast<float>(u_1 - u_0);
  tile.ray_per_px.col(1) = (ray(mid_u, v_1) - ray(mid_u, v_0)) / static_cast<float>(v_1 - v_0);
  const Eigen::Vector2f margin = tile.ray_per_px.cwiseAbs().rowwise().sum();  // a whole pixel on each side
  tile.bounds.min_x -= margin.x();
  tile.bounds.max_x += margin.x();
  tile.bounds.min_y -= margin.y();
  tile.bounds.max_y += margin.y();
  tiles_.push_back(tile);
}

}  // namespace apriltrack
