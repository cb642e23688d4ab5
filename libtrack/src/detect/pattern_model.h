#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "apriltrack/tags/blurred_pattern.h"
#include "edge_frame.h"
#include "pattern_pixels.h"
#include "pattern_step.h"
#include "pattern_texture.h"

namespace apriltrack {

// What a tag's picture depends on, by the first index of each group.

/// The place moves by the eight generators of projective maps of the tag's plane: (1, 0), (0, 1), (u, 0),
/// (v, 0), (0, u), (0, v), (u^2, uv), (uv, v^2).
inline constexpr int kPlaceUnknowns = 0;
/// xx, xy, yy of the lens's and the motion's covariance, straightened px^2.
inline constexpr int kBlurUnknowns = 8;
/// Where no camera is known: x and y by r^2, and radially by r^3.
inline constexpr int kBendUnknowns = 11;
inline constexpr int kWhiteUnknowns = 14;   ///< Of white less black: at the centre, per u, per v.
inline constexpr int kBlackUnknowns = 17;   ///< The same.
inline constexpr int kBeyondUnknowns = 20;  ///< Of what lies beyond each side, less white paper.
inline constexpr int kNumPatternUnknowns = 24;
inline constexpr int kNumColours = kNumPatternUnknowns - kWhiteUnknowns;
using PatternStep = Eigen::Matrix<double, kNumPatternUnknowns, 1>;

/// A value of the unknowns.
struct PatternState {
  Eigen::Matrix3d tag_from_straight;
  Eigen::Matrix2d blur_px2;  ///< Straightened; the pixel's own area is not in it.
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, kNumColours, 1> colours = Eigen::Matrix<double, kNumColours, 1>::Zero();

  /// Black all over, under an even blur. blur_sigma_px: in the image, the pixel's own area included.
  static PatternState start(const TagPlaces& places, const Eigen::Matrix3d& straight_from_tag,
                            double blur_sigma_px);

  double contrast() const { return colours[0]; }  ///< White less black, linear light.
  /// Takes a step, of which a corner moves at most `max_move` and a blur stays one that a lens may have:
  /// *step becomes what was taken of it. Returns how far the corners moved. Both in half tag sizes.
  double take(PatternStep* step, double max_move);
};

/// What the model says of some pixels.
struct PatternPrediction {
  /// Derivatives of the light. Those by place and bend are of the printed cells alone: not of the slopes of
  /// light, nor of what lies beyond the print, whose edge need not be where the family has it; nor do they
  /// follow the blur in the plane, which changes with the place.
  Eigen::Matrix<double, kNumPatternUnknowns, Eigen::Dynamic> by_unknowns;
  Eigen::VectorXd residuals;  ///< Light less what is predicted.
  Eigen::VectorXd gradient2;  ///< Square of the predicted light's gradient, per px.
  /// 1 where a pixel's light comes from the print and the sensor tells it, else 0: a full sensor contradicts
  /// nothing that is brighter.
  Eigen::VectorXd counts;
};

/// Predicts the light of pixels that show a tag: equation (9) of docs/algorithms/detector.md.
class PatternModel {
 public:
  PatternModel(const BlurredPattern& pattern, const TagPlaces& places) : pattern_(pattern), places_(places) {}

  double cell_size() const { return pattern_.cell_size(); }  ///< In half tag sizes.
  bool is_straightened() const { return places_.is_straightened(); }
  /// max_blur_change: the share of itself by which the blur may change before a texture is made anew.
  void predict(const PatternState& state, std::span<const PatternPixel> pixels, double max_blur_change,
               PatternPrediction* prediction);

  struct Corners {
    Quad px;
    /// Derivatives of x0 y0 x1 ..., px: by place and bend, zero by what moves no corner.
    Eigen::Matrix<double, 8, kNumPatternUnknowns> by_unknowns;
  };
  /// nullopt where the lens does not show them.
  std::optional<Corners> corners(const PatternState& state) const;
  /// Of lens and motion, in the image.
  Eigen::Matrix2d blur_px2(const PatternState& state) const;
  /// The same as one number, the pixel's own area included.
  double blur_sigma_px(const PatternState& state) const;

 private:
  void prepare_texture(const PatternState& state, const Eigen::Matrix2d& blur, double max_blur_change,
                       std::size_t num_pixels);
  void predict_pixel(const PatternState& state, const PatternPixel& pixel, const Eigen::Matrix2d& blur,
                     Eigen::Index i, PatternPrediction* prediction) const;

  const BlurredPattern& pattern_;
  const TagPlaces& places_;
  std::optional<PatternTexture> texture_;
};

}  // namespace apriltrack
