#include "room_view.h"

#include <algorithm>
#include <cmath>

namespace apriltrack {
namespace {

/// Texel coordinates on one level of a texture; texel centres at whole numbers.
struct LevelScale {
  const Image<float>* image = nullptr;
  float scale = 1.0F;
  float shift = 0.0F;
  float max_column = 0.0F;
  float max_row = 0.0F;

  LevelScale(const Texture& texture, int level) : image(&texture.level(level)) {
    constexpr float kBelowLast = 1.001F;  // so that the next texel exists
    scale = std::ldexp(1.0F, -level);
    shift = 0.5F * scale - 0.5F;
    max_column = static_cast<float>(image->width()) - kBelowLast;
    max_row = static_cast<float>(image->height()) - kBelowLast;
  }
};

inline float clamp_to(float value, float high) {
  value = value > 0.0F ? value : 0.0F;
  return value < high ? value : high;
}

inline float bilinear(const float* texel, std::ptrdiff_t stride, float right, float down) {
  const float top = texel[0] + right * (texel[1] - texel[0]);
  const float bottom = texel[stride] + right * (texel[stride + 1] - texel[stride]);
  return top + down * (bottom - top);
}

float sample(const LevelScale& level, float column, float row) {
  const float u = clamp_to(column * level.scale + level.shift, level.max_column);
  const float v = clamp_to(row * level.scale + level.shift, level.max_row);
  const int iu = static_cast<int>(u);
  const int iv = static_cast<int>(v);
  return bilinear(level.image->row(iv) + iu, level.image->width(), u - static_cast<float>(iu),
                  v - static_cast<float>(iv));
}

/// Plain loops over short arrays: the first is turned into wide instructions by the compiler, the second is
/// bound by the four reads.
void sample_row(const RayForm& column, const RayForm& row, const RayForm& depth, const LevelScale& level,
                const float* ray_x, const float* ray_y, int count, float* out) {
  float right[kTileWidth];
  float down[kTileWidth];
  int offset[kTileWidth];
  const int stride = level.image->width();
  for (int i = 0; i < count; ++i) {
    const float scale = level.scale / depth.at(ray_x[i], ray_y[i]);
    const float u = clamp_to(column.at(ray_x[i], ray_y[i]) * scale + level.shift, level.max_column);
    const float v = clamp_to(row.at(ray_x[i], ray_y[i]) * scale + level.shift, level.max_row);
    const int iu = static_cast<int>(u);
    const int iv = static_cast<int>(v);
    right[i] = u - static_cast<float>(iu);
    down[i] = v - static_cast<float>(iv);
    offset[i] = iv * stride + iu;
  }
  const float* texels = level.image->row(0);
  for (int i = 0; i < count; ++i) out[i] = bilinear(texels + offset[i], stride, right[i], down[i]);
}

/// Point number `index` of the plastic-number sequence (Roberts 2018) in the unit square: evenly spread for
/// any count.
Eigen::Vector2f spread_point(int index) {
  const double u = 0.5 + 0.7548776662466927 * index;
  const double v = 0.5 + 0.5698402909980532 * index;
  return {static_cast<float>(u - std::floor(u) - 0.5), static_cast<float>(v - std::floor(v) - 0.5)};
}

}  // namespace

RoomView::RoomView(const Room& room, const Pose& T_world_camera) {
  const Eigen::Matrix3d R = T_world_camera.rotation_matrix();
  const Eigen::Vector3d& eye = T_world_camera.translation();
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const int a = (axis + 1) % 3;
    const int b = (axis + 2) % 3;
    const double to_wall = (face % 2 == 0 ? room.min_corner : room.max_corner)[axis] - eye[axis];
    const double texel = room.radiance[static_cast<std::size_t>(face)]->texel_m();
    const Eigen::Vector3d inverse_depth = R.row(axis).transpose() / to_wall;
    const auto texels_along = [&](int along) -> Eigen::Vector3d {
      const double start = eye[along] - room.min_corner[along];
      return (start * inverse_depth + R.row(along).transpose()) / texel - 0.5 * inverse_depth;
    };
    walls_[static_cast<std::size_t>(face)] = {RayForm(texels_along(a)), RayForm(texels_along(b)),
                                              RayForm(inverse_depth),
                                              room.radiance[static_cast<std::size_t>(face)].get()};
  }
}

int RoomView::wall_hit(float ray_x, float ray_y) const {
  int hit = 0;
  float nearest = walls_[0].inverse_depth.at(ray_x, ray_y);
  for (int i = 1; i < 6; ++i) {
    const float inverse_depth = walls_[static_cast<std::size_t>(i)].inverse_depth.at(ray_x, ray_y);
    if (inverse_depth > nearest) {
      nearest = inverse_depth;
      hit = i;
    }
  }
  return hit;
}

/// The level whose texels are about as large as a pixel at the tile's centre.
int RoomView::level_of_detail(const Wall& wall, const Tile& tile) {
  const float x = tile.centre.x();
  const float y = tile.centre.y();
  const float inverse = 1.0F / std::max(wall.inverse_depth.at(x, y), 1e-3F);
  const float u = wall.column.at(x, y) * inverse;
  const float v = wall.row.at(x, y) * inverse;
  Eigen::Matrix2f texel_per_ray;
  texel_per_ray << wall.column.x - u * wall.inverse_depth.x, wall.column.y - u * wall.inverse_depth.y,
      wall.row.x - v * wall.inverse_depth.x, wall.row.y - v * wall.inverse_depth.y;
  const float texel_per_px = std::sqrt(std::abs((inverse * texel_per_ray * tile.ray_per_px).determinant()));
  const int level = static_cast<int>(std::lround(std::log2(std::max(texel_per_px, 1.0F))));
  return std::min(level, wall.radiance->num_levels() - 1);
}

void RoomView::draw_wall(const Wall& wall, const TileLook& look, float* out) {
  const Tile& tile = look.tile;
  const LevelScale level(*wall.radiance, level_of_detail(wall, tile));
  for (int y = 0; y < tile.height; ++y) {
    sample_row(wall.column, wall.row, wall.inverse_depth, level, look.ray_x(y), look.ray_y(y), tile.width,
               out + y * kTileWidth);
  }
}

void RoomView::draw_edges(const TileLook& look, int num_samples, int instant, float* out) const {
  const Tile& tile = look.tile;
  std::array<int, 6> levels{};
  for (std::size_t i = 0; i < 6; ++i) levels[i] = level_of_detail(walls_[i], tile);
  std::fill_n(out, kTileArea, 0.0F);
  const float weight = 1.0F / static_cast<float>(num_samples);
  for (int s = 0; s < num_samples; ++s) {
    const Eigen::Vector2f aside = tile.ray_per_px * spread_point(instant * num_samples + s);
    for (int y = 0; y < tile.height; ++y) {
      const float* ray_x = look.ray_x(y);
      const float* ray_y = look.ray_y(y);
      for (int x = 0; x < tile.width; ++x) {
        const float rx = ray_x[x] + aside.x();
        const float ry = ray_y[x] + aside.y();
        const auto hit = static_cast<std::size_t>(wall_hit(rx, ry));
        const Wall& wall = walls_[hit];
        const float depth = 1.0F / wall.inverse_depth.at(rx, ry);
        out[y * kTileWidth + x] +=
            weight * sample(LevelScale(*wall.radiance, levels[hit]), wall.column.at(rx, ry) * depth,
                            wall.row.at(rx, ry) * depth);
      }
    }
  }
}

void RoomView::draw(const TileLook& look, int num_samples, int instant, float* out) const {
  const Tile& tile = look.tile;
  // A wall's outline is convex in the plane of rays, so a tile with its corners on one wall lies on it.
  const int hit = wall_hit(tile.corners[0].x(), tile.corners[0].y());
  const bool is_one_wall =
      std::all_of(tile.corners.begin() + 1, tile.corners.end(),
                  [&](const Eigen::Vector2f& c) { return wall_hit(c.x(), c.y()) == hit; });
  if (is_one_wall) {
    draw_wall(walls_[static_cast<std::size_t>(hit)], look, out);
  } else {
    draw_edges(look, num_samples, instant, out);
  }
}

}  // namespace apriltrack
