#pragma once

#include <Eigen/Core>
#include <vector>

#include "tag_pixels.h"
#include "tag_prediction.h"

namespace apriltrack {

/// How a tag and its surroundings look in this frame, in linear light:
/// light = gain * pattern + black * presence + background * (1 - presence).
struct TagColours {
  double gain = 0.0;
  double black = 0.0;
  double background = 0.0;
};

/// How a tag's pixels fit a state.
struct TagMisfit {
  TagColours colours;
  double correlation = 0.0;  ///< sqrt(1 - residual / total variance); 0 where the gain is negative.
  /// Of the total variance: of residuals, what differs from pixel to pixel. Where the correlation is.
  double noise_share = 0.0;
  double residual_scale = 0.0;  ///< Robust standard deviation of the residuals; where it was asked for.
  double cost = 0.0;  ///< -log likelihood under bounded errors of the scale given, up to a constant.
};

/// The colours that fit best, and what is left. scale: of the residuals, beyond which they count less and
/// less (Geman and McClure's penalty); 0: plain least squares, which also measures the residuals' scale.
/// scratch: overwritten, its memory used again.
TagMisfit measure_misfit(const TagPixels& pixels, const PredictedPixels& predicted, double scale,
                         std::vector<float>* scratch);

/// Gauss-Newton's view of measure_misfit's cost, in [left perturbation of the camera's view of the map; of
/// its rate]; the colours are eliminated.
struct TagNormalEquations {
  Eigen::Matrix<double, 12, 12> H = Eigen::Matrix<double, 12, 12>::Zero();
  Eigen::Matrix<double, 12, 1> g = Eigen::Matrix<double, 12, 1>::Zero();
};
TagNormalEquations linearise(const TagPixels& pixels, const TagPrediction& prediction,
                             const TagColours& colours, double scale);

}  // namespace apriltrack
