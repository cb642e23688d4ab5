#pragma once

#include <cstddef>
#include <cstdint>
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

/// A point of a texture as it is kept: shares of kOne.
struct Texel {
  static constexpr float kOne = 32767.0F;
  std::uint16_t light = 0, presence = 0;
};

/// Texels, and how the plane lies on them: column = (u + half_width) * columns_per_unit, and so for rows.
struct TexelGrid {
  const Texel* texels = nullptr;  ///< Row by row.
  int width = 0;
  float half_width = 0.0F, half_height = 0.0F;          ///< In half tag sizes.
  float columns_per_unit = 0.0F, rows_per_unit = 0.0F;  ///< Texels per half tag size.
  float last_column = 0.0F, last_row = 0.0F;            ///< Beyond them there is nothing.
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
    return sample_texels((u + grid_.half_width) * grid_.columns_per_unit,
                         (v + grid_.half_height) * grid_.rows_per_unit);
  }
  PatternSample sample(float u, float v, PatternGradient& gradient) const {
    const PatternSample found = sample_texels((u + grid_.half_width) * grid_.columns_per_unit,
                                              (v + grid_.half_height) * grid_.rows_per_unit, &gradient);
    gradient.light_u *= grid_.columns_per_unit;
    gradient.presence_u *= grid_.columns_per_unit;
    gradient.light_v *= grid_.rows_per_unit;
    gradient.presence_v *= grid_.rows_per_unit;
    return found;
  }

  /// The same at a place in texels. gradient, where it is asked for: per texel.
  PatternSample sample_texels(float column, float row, PatternGradient* gradient = nullptr) const;

  /// Points into this texture.
  TexelGrid grid() const {
    TexelGrid grid = grid_;
    grid.texels = texels_.data();
    return grid;
  }
  std::size_t num_bytes() const { return texels_.size() * sizeof(Texel); }

 private:
  TexelGrid grid_;  ///< Without its texels: textures may be copied.
  std::vector<Texel> texels_;
};

}  // namespace apriltrack
