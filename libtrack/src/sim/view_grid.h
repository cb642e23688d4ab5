#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/image/image.h"

namespace apriltrack {

inline constexpr int kTileWidth = 32;
inline constexpr int kTileHeight = 8;
inline constexpr int kTileArea = kTileWidth * kTileHeight;

/// Bounds in ray coordinates (x/z, y/z).
struct RayBounds {
  float min_x = 0.0F;
  float max_x = 0.0F;
  float min_y = 0.0F;
  float max_y = 0.0F;

  bool touches(const RayBounds& other) const {
    return min_x <= other.max_x && other.min_x <= max_x && min_y <= other.max_y && other.min_y <= max_y;
  }
};

/// A patch of the image small enough that the lens is straight in it.
struct Tile {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  RayBounds bounds{};  ///< Of the pixels' whole areas.
  std::array<Eigen::Vector2f, 4> corners{};
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();
  /// d ray / d pixel.
  Eigen::Matrix2f ray_per_px = Eigen::Matrix2f::Identity();
};

/// A tile seen a little aside of its pixels' centres.
struct TileLook {
  Tile tile;  ///< With bounds, corners and centre moved aside.
  alignas(32) float rays_x[kTileArea];
  alignas(32) float rays_y[kTileArea];

  const float* ray_x(int row) const { return rays_x + row * kTileWidth; }
  const float* ray_y(int row) const { return rays_y + row * kTileWidth; }
};

/// The ray of every pixel of a camera, with the lens undone once and for all.
class ViewGrid {
 public:
  explicit ViewGrid(const Camera& camera);

  int width() const { return ray_x_.width(); }
  int height() const { return ray_x_.height(); }
  const std::vector<Tile>& tiles() const { return tiles_; }
  void look(const Tile& tile, const Eigen::Vector2f& offset_px, TileLook& out) const;
  /// False outside the lens model's domain: such pixels stay black.
  bool is_seen(int x, int y) const { return is_seen_(x, y) != 0; }
  bool sees_everywhere() const { return sees_everywhere_; }

 private:
  void trace_pixels(const CameraModel& model);
  void make_tile(int x, int y);

  Image<float> ray_x_;
  Image<float> ray_y_;
  Image<unsigned char> is_seen_;
  bool sees_everywhere_ = true;
  std::vector<Tile> tiles_;
};

}  // namespace apriltrack
