#pragma once

#include <Eigen/Core>
#include <array>

#include "apriltrack/geometry/pose.h"
#include "apriltrack/sim/scene.h"
#include "view_grid.h"

namespace apriltrack {

/// A linear function of a ray (x, y, 1).
struct RayForm {
  float x = 0.0F;
  float y = 0.0F;
  float one = 0.0F;

  RayForm() = default;
  explicit RayForm(const Eigen::Vector3d& v)
      : x(static_cast<float>(v.x())), y(static_cast<float>(v.y())), one(static_cast<float>(v.z())) {}

  float at(float ray_x, float ray_y) const { return x * ray_x + y * ray_y + one; }
};

/// The room as one instant sees it: a plane of texels per wall, as ratios of linear functions of the ray.
class RoomView {
 public:
  RoomView() = default;
  RoomView(const Room& room, const Pose& T_world_camera);

  /// Radiance of the tile's pixels, row by row with stride kTileWidth. Where walls meet in the tile, each
  /// pixel is the mean of num_samples points, which differ from instant to instant.
  void draw(const TileLook& look, int num_samples, int instant, float* out) const;

 private:
  struct Wall {
    RayForm column;  ///< Texel column = column / inverse_depth.
    RayForm row;
    RayForm inverse_depth;  ///< 1 / z of the hit; the wall that is hit has the largest.
    const Texture* radiance = nullptr;
  };

  int wall_hit(float ray_x, float ray_y) const;
  static int level_of_detail(const Wall& wall, const Tile& tile);
  static void draw_wall(const Wall& wall, const TileLook& look, float* out);
  void draw_edges(const TileLook& look, int num_samples, int instant, float* out) const;

  std::array<Wall, 6> walls_;
};

}  // namespace apriltrack
