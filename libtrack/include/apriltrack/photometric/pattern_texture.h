#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "apriltrack/tags/tag_family.h"

namespace apriltrack {

/// What a point of the tag's plane contributes to a pixel, with gradients in the plane's units.
struct PatternSample {
  float light = 0.0F;     ///< Blurred brightness times presence: 0 for black and beyond the tag.
  float presence = 0.0F;  ///< Blurred 1 on the printed cells, 0 beyond: how much of the pixel is tag.
  Eigen::Vector2f light_gradient = Eigen::Vector2f::Zero();
  Eigen::Vector2f presence_gradient = Eigen::Vector2f::Zero();
};

/// The printed cells of a tag, blurred by a Gaussian along the axes of its plane.
///
/// The plane is measured in half tag sizes, as TagPattern's. Beyond the printed cells nothing is known, so
/// that light comes with the share of the blur kernel that lies on print. The Gaussian's integral over each
/// cell is exact at the texture's points (error functions); between them it is interpolated bilinearly.
class PatternTexture {
 public:
  /// sigma_u, sigma_v: in half tag sizes. Texels are three quarters of a sigma wide, within an eighth and a
  /// 48th of a cell; a sigma too small for its texels counts as large enough.
  PatternTexture(const TagPattern& pattern, double sigma_u, double sigma_v);

  PatternSample sample(float u, float v) const {
    const float x = (u + half_width_) * columns_per_unit_;
    const float y = (v + half_height_) * rows_per_unit_;
    PatternSample result;
    if (!(x >= 0.0F && y >= 0.0F && x < last_column_ && y < last_row_)) return result;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
    const Eigen::Vector2f* top = texels_.data() + row * width_ + column;
    const Eigen::Vector2f* bottom = top + width_;
    const Eigen::Vector2f left = top[0] + fy * (bottom[0] - top[0]);
    const Eigen::Vector2f right = top[1] + fy * (bottom[1] - top[1]);
    const Eigen::Vector2f du = (right - left) * columns_per_unit_;
    const Eigen::Vector2f value = left + fx * (right - left);
    const Eigen::Vector2f dv =
        ((bottom[0] - top[0]) * (1.0F - fx) + (bottom[1] - top[1]) * fx) * rows_per_unit_;
    result.light = value[0];
    result.presence = value[1];
    result.light_gradient = {du[0], dv[0]};
    result.presence_gradient = {du[1], dv[1]};
    return result;
  }

 private:
  float half_width_ = 0.0F, half_height_ = 0.0F;
  float columns_per_unit_ = 0.0F, rows_per_unit_ = 0.0F;  ///< Texels per half tag size.
  float last_column_ = 0.0F, last_row_ = 0.0F;
  int width_ = 0;
  std::vector<Eigen::Vector2f> texels_;  ///< (light, presence), row by row.
};

/// Textures of one tag, made when first asked for, in steps of 2^(1/4) of each sigma. Bounded: sigmas stop at
/// three cells, where no cell is left to see, and only the textures used last are kept.
class PatternTextures {
 public:
  explicit PatternTextures(TagPattern pattern) : pattern_(std::move(pattern)) {}

  std::shared_ptr<const PatternTexture> blurred(double sigma_u, double sigma_v);
  const TagPattern& pattern() const { return pattern_; }

 private:
  struct Entry {
    int level_u = 0, level_v = 0;
    std::shared_ptr<const PatternTexture> texture;
  };
  TagPattern pattern_;
  std::vector<Entry> entries_;  ///< The one used last at the end.
};

}  // namespace apriltrack
