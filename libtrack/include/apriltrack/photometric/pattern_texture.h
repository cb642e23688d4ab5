#pragma once

#include <cstddef>
#include <vector>

#include "apriltrack/tags/tag_family.h"

namespace apriltrack {

/// What a point of the tag's plane contributes to a pixel.
struct PatternSample {
  float light = 0.0F;     ///< Blurred brightness times presence: 0 for black and beyond the tag.
  float presence = 0.0F;  ///< Blurred 1 on the printed cells, 0 beyond: how much of the pixel is tag.
};

/// Derivatives of a PatternSample in the plane's units.
struct PatternGradient {
  float light_u = 0.0F, light_v = 0.0F, presence_u = 0.0F, presence_v = 0.0F;
};

/// The printed cells of a tag, blurred by a Gaussian along the axes of its plane.
///
/// The plane is measured in half tag sizes, as TagPattern's. Beyond the printed cells, and on those that the
/// family leaves to the printer, nothing is known, so that light comes with the share of the blur kernel that
/// lies on print. The Gaussian's integral over each
/// cell is exact at the texture's points (error functions); between them it is interpolated bilinearly.
class PatternTexture {
 public:
  /// sigma_u, sigma_v: in half tag sizes. Texels are three quarters of a sigma wide, within an eighth and a
  /// 48th of a cell; a sigma too small for its texels counts as large enough.
  PatternTexture(const TagPattern& pattern, double sigma_u, double sigma_v);

  PatternSample sample(float u, float v) const {
    Cell cell;
    if (!find_cell(u, v, cell)) return {};
    const Texel *a = cell.top, *b = cell.top + width_;
    const float left_light = a[0].light + cell.fy * (b[0].light - a[0].light);
    const float right_light = a[1].light + cell.fy * (b[1].light - a[1].light);
    const float left_presence = a[0].presence + cell.fy * (b[0].presence - a[0].presence);
    const float right_presence = a[1].presence + cell.fy * (b[1].presence - a[1].presence);
    return {left_light + cell.fx * (right_light - left_light),
            left_presence + cell.fx * (right_presence - left_presence)};
  }

  PatternSample sample(float u, float v, PatternGradient& gradient) const {
    Cell cell;
    gradient = {};
    if (!find_cell(u, v, cell)) return {};
    const Texel *a = cell.top, *b = cell.top + width_;
    const float light_below = b[0].light - a[0].light, light_below_right = b[1].light - a[1].light;
    const float presence_below = b[0].presence - a[0].presence;
    const float presence_below_right = b[1].presence - a[1].presence;
    const float left_light = a[0].light + cell.fy * light_below;
    const float across_light = a[1].light + cell.fy * light_below_right - left_light;
    const float left_presence = a[0].presence + cell.fy * presence_below;
    const float across_presence = a[1].presence + cell.fy * presence_below_right - left_presence;
    gradient.light_u = across_light * columns_per_unit_;
    gradient.presence_u = across_presence * columns_per_unit_;
    gradient.light_v = (light_below + cell.fx * (light_below_right - light_below)) * rows_per_unit_;
    gradient.presence_v =
        (presence_below + cell.fx * (presence_below_right - presence_below)) * rows_per_unit_;
    return {left_light + cell.fx * across_light, left_presence + cell.fx * across_presence};
  }

  std::size_t num_bytes() const { return texels_.size() * sizeof(Texel); }

 private:
  struct Texel {
    float light, presence;
  };
  /// The four texels around a point.
  struct Cell {
    const Texel* top = nullptr;
    float fx = 0.0F, fy = 0.0F;
  };

  bool find_cell(float u, float v, Cell& cell) const {
    const float x = (u + half_width_) * columns_per_unit_;
    const float y = (v + half_height_) * rows_per_unit_;
    if (!(x >= 0.0F && y >= 0.0F && x < last_column_ && y < last_row_)) return false;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    cell = {texels_.data() + row * width_ + column, x - static_cast<float>(column),
            y - static_cast<float>(row)};
    return true;
  }

  float half_width_ = 0.0F, half_height_ = 0.0F;
  float columns_per_unit_ = 0.0F, rows_per_unit_ = 0.0F;  ///< Texels per half tag size.
  float last_column_ = 0.0F, last_row_ = 0.0F;
  int width_ = 0;
  std::vector<Texel> texels_;  ///< Row by row.
};

}  // namespace apriltrack
