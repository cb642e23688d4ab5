#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "apriltrack/photometric/pattern_texture.h"

namespace apriltrack {

/// What is done for every pixel of a tag, many at a time. The instruction set is chosen when the program
/// runs; `TagPrediction::predict` is the definition that the kernels are held against.
///
/// Columns: one number for each pixel, their length a multiple of kPixelBlock. What fills a column up has a
/// weight of zero.
inline constexpr std::size_t kPixelBlock = 16;

/// `count` and what fills it up.
constexpr std::size_t padded(std::size_t count) {
  return (count + kPixelBlock - 1) / kPixelBlock * kPixelBlock;
}

/// The tag's plane at one instant of the exposure, measured in texels.
struct TexelInstant {
  /// (x / z, y / z, 1) of a ray to homogeneous (column, row, 1 / depth), row by row.
  std::array<float, 9> texel_from_ray{};
  float time_s = 0.0F;
};

/// A tag along its path.
struct TexelPath {
  TexelGrid grid;
  std::span<const TexelInstant> instants;
};

/// Rays of pixels, (x / z) and (y / z).
struct RayColumns {
  const float* x = nullptr;
  const float* y = nullptr;
  std::size_t count = 0;  ///< Padded.
};

/// Mean light and presence of the pattern along the path.
void predict_pixels(const TexelPath& path, const RayColumns& rays, float* light, float* presence);

/// A tag's colours in single precision.
struct ColourFactors {
  float gain, black, background;
};

/// Weighted sums of products of (light, presence, 1 - presence) with each other and with the image's light.
struct ColourSums {
  double ll = 0.0, lp = 0.0, lb = 0.0, pp = 0.0, pb = 0.0, bb = 0.0;
  double li = 0.0, pi = 0.0, bi = 0.0;
};

/// What is predicted and seen of a tag's pixels.
struct SeenColumns {
  const float* light = nullptr;          ///< Predicted,
  const float* presence = nullptr;       ///< likewise;
  const float* image = nullptr;          ///< the frame's light,
  const float* inverse_sigma = nullptr;  ///< and 1 over its expected relative error; 0 fills up.
  std::size_t count = 0;                 ///< Padded.
};

/// weights: null stands for inverse_sigma^2.
ColourSums sum_colours(const SeenColumns& pixels, const float* weights);

/// sizes: |residual| over its expected relative error.
void residual_sizes(const SeenColumns& pixels, const ColourFactors& colours, float* sizes);

/// Of sizes that are not negative, the one that `rank` others come before. count: padded.
float size_of_rank(const float* sizes, std::size_t count, std::size_t rank);

/// Weighted sum of the squares of white noise alone: half the mean square of what neighbours in a row differ
/// by (von Neumann 1941), for the residuals of a wrong state are alike from pixel to pixel. weights: 0 fills
/// up.
double noise_power(const SeenColumns& pixels, const ColourFactors& colours, const float* weights);

/// Of residuals under Geman and McClure's penalty, with `scale` and `reach` as its units.
struct MisfitSums {
  double cost = 0.0;       ///< Half the sum of the penalties.
  double weight = 0.0;     ///< Of all weights,
  double image = 0.0;      ///< weighted: of the image's light less the tag's middle grey,
  double image2 = 0.0;     ///< of its square,
  double residual2 = 0.0;  ///< and of the squared residuals.
};

/// inverse_scale: 0 for plain least squares, without a cost. weights: written.
MisfitSums weigh_residuals(const SeenColumns& pixels, const ColourFactors& colours, float inverse_scale,
                           float reach, float* weights);

/// Gram matrix of the weighted rows [12 of motion; 3 of colour; residual], 16 x 16; both triangles.
using GramMatrix = std::array<double, 256>;

/// The derivatives of the prediction by a left perturbation of the camera's view of the map and by its rate.
GramMatrix linearise_pixels(const TexelPath& path, const RayColumns& rays, const float* image,
                            const float* inverse_sigma, const ColourFactors& colours, float inverse_scale,
                            float reach);

}  // namespace apriltrack
