#include "tag_photometry.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/base/geman_mcclure.h"

namespace apriltrack {
namespace {

/// Of a pixel's residual, in scales: hands and glare are not the tag.
constexpr GemanMcClure kPixelError(2.5);
/// Pull of the background towards the black of the tag, in pixels: settles it where no pixel shows any.
constexpr double kBackgroundRidge = 0.5;

Eigen::Vector3d basis(const PixelPrediction& prediction) {
  return {prediction.light, prediction.presence, 1.0 - prediction.presence};
}

TagColours solve_colours(const TagPixels& pixels, const std::vector<PixelPrediction>& predictions,
                         const std::vector<double>& weights) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const Eigen::Vector3d f = basis(predictions[i]);
    A += weights[i] * f * f.transpose();
    b += weights[i] * pixels.pixels[i].light * f;
  }
  const Eigen::Vector3d pull(0.5, 1.0, -1.0);  // background = black + gain / 2
  A += kBackgroundRidge * pull * pull.transpose();
  A.diagonal().array() += 1e-9;
  const Eigen::Vector3d x = A.ldlt().solve(b);
  return {x[0], x[1], x[2]};
}

double residual(const TagColours& colours, const PixelPrediction& prediction, float light) {
  return colours.gain * prediction.light + colours.black * prediction.presence +
         colours.background * (1.0 - prediction.presence) - light;
}

double prior_weight(const TagPixel& pixel) {
  return 1.0 / static_cast<double>(pixel.relative_sigma * pixel.relative_sigma);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

TagMisfit measure_misfit(const TagPixels& pixels, const TagPrediction& prediction, double scale) {
  const std::size_t n = pixels.pixels.size();
  std::vector<PixelPrediction> predictions(n);
  for (std::size_t i = 0; i < n; ++i) predictions[i] = prediction.predict(pixels.pixels[i].ray);
  TagMisfit misfit;
  std::vector<double> weights(n), sizes(n);
  for (std::size_t i = 0; i < n; ++i) weights[i] = prior_weight(pixels.pixels[i]);
  const int rounds = scale > 0.0 ? 3 : 1;
  for (int round = 0; round < rounds; ++round) {
    misfit.colours = solve_colours(pixels, predictions, weights);
    for (std::size_t i = 0; i < n; ++i) {
      const TagPixel& pixel = pixels.pixels[i];
      sizes[i] = std::abs(residual(misfit.colours, predictions[i], pixel.light)) / pixel.relative_sigma;
      if (scale > 0.0)
        weights[i] = prior_weight(pixel) * kPixelError.weight(sizes[i] * sizes[i] / (scale * scale));
    }
  }
  double sum_w = 0.0, mean = 0.0, left = 0.0, total = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    sum_w += weights[i];
    mean += weights[i] * pixels.pixels[i].light;
    const double sigma = pixels.pixels[i].relative_sigma;
    left += weights[i] * sigma * sigma * sizes[i] * sizes[i];
    if (scale > 0.0) misfit.cost += 0.5 * kPixelError.penalty(sizes[i] * sizes[i] / (scale * scale));
  }
  mean /= std::max(1e-12, sum_w);
  for (std::size_t i = 0; i < n; ++i) {
    const double off = pixels.pixels[i].light - mean;
    total += weights[i] * off * off;
  }
  misfit.residual_scale = 1.4826 * median(std::move(sizes));
  if (misfit.colours.gain > 0.0 && total > 0.0)
    misfit.correlation = std::sqrt(std::max(0.0, 1.0 - left / total));
  return misfit;
}

TagNormalEquations linearise(const TagPixels& pixels, const TagPrediction& prediction,
                             const TagColours& colours, double scale) {
  using Row = Eigen::Matrix<double, 15, 1>;  // twelve of motion, three of colour
  Eigen::Matrix<double, 15, 15> H = Eigen::Matrix<double, 15, 15>::Zero();
  Row g = Row::Zero();
  PixelJacobian jacobian;
  const auto by_light = static_cast<float>(colours.gain);
  const auto by_presence = static_cast<float>(colours.black - colours.background);
  for (const TagPixel& pixel : pixels.pixels) {
    const PixelPrediction predicted = prediction.predict(pixel.ray, jacobian);
    const double sigma = scale * pixel.relative_sigma;
    const double r = residual(colours, predicted, pixel.light) / sigma;
    const double w = kPixelError.weight(r * r);
    Row row;
    for (std::size_t k = 0; k < 6; ++k) {
      const auto index = static_cast<Eigen::Index>(k);
      row[index] = by_light * jacobian.light_by_pose[k] + by_presence * jacobian.presence_by_pose[k];
      row[index + 6] = by_light * jacobian.light_by_rate[k] + by_presence * jacobian.presence_by_rate[k];
    }
    row.segment<3>(12) = basis(predicted);
    row /= sigma;
    H.selfadjointView<Eigen::Lower>().rankUpdate(row, w);
    g += w * r * row;
  }
  H = H.selfadjointView<Eigen::Lower>();
  Eigen::Matrix3d colour_block = H.block<3, 3>(12, 12);
  colour_block.diagonal().array() += 1e-9 + 1e-6 * colour_block.trace();
  const Eigen::Matrix<double, 12, 3> coupling = H.block<12, 3>(0, 12);
  const Eigen::Matrix<double, 12, 3> eliminated = colour_block.ldlt().solve(coupling.transpose()).transpose();
  TagNormalEquations result;
  result.H = H.block<12, 12>(0, 0) - eliminated * coupling.transpose();
  result.g = g.head<12>() - eliminated * g.tail<3>();
  return result;
}

}  // namespace apriltrack
