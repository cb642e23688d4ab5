#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apriltrack/sim/scene.h"
#include "room_view.h"
#include "tag_cells.h"
#include "view_grid.h"

namespace apriltrack {

/// A panel with what can be prepared once for all frames.
struct PreparedPanel {
  const Panel* panel = nullptr;
  std::shared_ptr<const TagCells> cells;  ///< Null: no tag.
  double unit_m = 1.0;                    ///< Units of the panel's plane: cells, texels or metres.
};

/// Colour times coverage, and coverage, of one body in one tile.
struct BodyLayer {
  alignas(32) float colour[kTileArea];
  alignas(32) float coverage[kTileArea];
};

/// A panel as one instant sees it.
class PanelView {
 public:
  /// nullopt when the panel turns its back or lies behind the camera.
  static std::optional<PanelView> make(const PreparedPanel& prepared, const Pose& T_camera_panel,
                                       const Pose& T_world_panel, const Lighting& lighting);

  const RayBounds& bounds() const { return bounds_; }

  /// splits: a pixel whose area holds an edge is cut into splits x splits parts.
  void draw(const TileLook& look, int splits, BodyLayer& layer) const;

 private:
  struct Footprint;
  struct RowOfAreas;
  struct Shown {
    float colour = 0.0F;  ///< Times coverage.
    float coverage = 0.0F;
  };

  void set_bounds(const Pose& T_camera_panel);
  void set_gloss(const Pose& T_panel_camera, const Pose& T_world_panel, const Lighting& lighting);
  void set_shading(const Pose& T_world_panel, const Lighting& lighting);
  bool trace_row(const Tile& tile, const float* ray_x, const float* ray_y, RowOfAreas& row) const;
  void put(float colour, float coverage, float& layer_colour, float& layer_coverage) const;
  Shown show(float u, float v, const Footprint& area, int splits) const;
  Shown show_part(float u, float v, float width_u, float width_v) const;
  float picture_at(const Texture& picture, float u, float v, float unit_per_px) const;
  Shown show_paint(float u, float v, float unit_per_px) const;
  float highlight(float u, float v) const;

  const PreparedPanel* prepared_ = nullptr;
  bool is_decal_ = false;
  RayForm u_;  ///< u = u_ / inverse_depth_, in units from the middle of the panel.
  RayForm v_;
  RayForm inverse_depth_;
  float half_u_ = 0.0F;
  float half_v_ = 0.0F;
  float shade_ = 1.0F;  ///< Irradiance, linear over the panel.
  float shade_per_u_ = 0.0F;
  float shade_per_v_ = 0.0F;
  float tag_u_ = 0.0F;  ///< Of the tag's middle, in units.
  float tag_v_ = 0.0F;
  float gloss_ = 0.0F;  ///< Radiance in the middle of the lamp's mirror image; 0: none is seen.
  float gloss_sharpness_ = 0.0F;
  Eigen::Vector3f lamp_ = Eigen::Vector3f::Zero();          ///< In units, frame of the panel.
  Eigen::Vector3f mirrored_eye_ = Eigen::Vector3f::Zero();  ///< Behind the panel.
  RayBounds bounds_;
};

}  // namespace apriltrack
