#include "tag_photometry.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pixel_kernels.h"

namespace apriltrack {
namespace {

/// Of a pixel's residual, in scales: hands and glare are not the tag.
constexpr float kPixelReach = 2.5F;
/// Pull of the background towards the black of the tag, in pixels: settles it where no pixel shows any.
constexpr double kBackgroundRidge = 0.5;
constexpr int kColourRounds = 3;  // of reweighting

SeenColumns seen_columns(const TagPixels& pixels, const PredictedPixels& predicted) {
  return {predicted.light.data(), predicted.presence.data(), pixels.image.data(), pixels.inverse_sigma.data(),
          pixels.image.size()};
}

ColourFactors factors(const TagColours& colours) {
  return {static_cast<float>(colours.gain), static_cast<float>(colours.black),
          static_cast<float>(colours.background)};
}

TagColours solve_colours(const ColourSums& sums) {
  Eigen::Matrix3d A;
  A << sums.ll, sums.lp, sums.lb, sums.lp, sums.pp, sums.pb, sums.lb, sums.pb, sums.bb;
  const Eigen::Vector3d b(sums.li, sums.pi, sums.bi);
  const Eigen::Vector3d pull(0.5, 1.0, -1.0);  // background = black + gain / 2
  A += kBackgroundRidge * pull * pull.transpose();
  A.diagonal().array() += 1e-9;
  const Eigen::Vector3d x = A.ldlt().solve(b);
  return {x[0], x[1], x[2]};
}

double median_size(const TagPixels& pixels, const SeenColumns& seen, const ColourFactors& colours,
                   std::vector<float>& sizes) {
  if (pixels.count == 0) return 0.0;
  sizes.resize(seen.count);
  residual_sizes(seen, colours, sizes.data());
  const std::size_t num_fillers = seen.count - pixels.count;  // of size 0
  return static_cast<double>(size_of_rank(sizes.data(), seen.count, num_fillers + pixels.count / 2));
}

}  // namespace

TagMisfit measure_misfit(const TagPixels& pixels, const PredictedPixels& predicted, double scale,
                         std::vector<float>* scratch) {
  const SeenColumns seen = seen_columns(pixels, predicted);
  const bool is_robust = scale > 0.0;
  const auto inverse_scale = static_cast<float>(is_robust ? 1.0 / scale : 0.0);
  std::vector<float>& weights = *scratch;
  weights.resize(seen.count);
  TagMisfit misfit;
  MisfitSums sums;
  for (int round = 0; round < (is_robust ? kColourRounds : 1); ++round) {
    misfit.colours = solve_colours(sum_colours(seen, round == 0 ? nullptr : weights.data()));
    sums = weigh_residuals(seen, factors(misfit.colours), inverse_scale, kPixelReach, weights.data());
  }
  misfit.cost = sums.cost;
  const double total = sums.image2 - sums.image * sums.image / std::max(1e-12, sums.weight);
  if (misfit.colours.gain > 0.0 && total > 0.0) {
    misfit.correlation = std::sqrt(std::max(0.0, 1.0 - sums.residual2 / total));
    misfit.noise_share = std::min(1.0, noise_power(seen, factors(misfit.colours), weights.data()) / total);
  }
  // Of a Gaussian's sizes, the median is 0.6745 standard deviations.
  if (!is_robust)
    misfit.residual_scale = 1.4826 * median_size(pixels, seen, factors(misfit.colours), *scratch);
  return misfit;
}

TagNormalEquations linearise(const TagPixels& pixels, const TagPrediction& prediction,
                             const TagColours& colours, double scale) {
  using Gram = Eigen::Matrix<double, 16, 16, Eigen::RowMajor>;  // twelve of motion, three of colour, residual
  const GramMatrix sums = linearise_pixels(prediction.texel_path(), pixels.rays(), pixels.image.data(),
                                           pixels.inverse_sigma.data(), factors(colours),
                                           static_cast<float>(1.0 / scale), kPixelReach);
  const Gram G = Eigen::Map<const Gram>(sums.data());
  Eigen::Matrix3d colour_block = G.block<3, 3>(12, 12);
  colour_block.diagonal().array() += 1e-9 + 1e-6 * colour_block.trace();
  const Eigen::Matrix<double, 12, 3> coupling = G.block<12, 3>(0, 12);
  const Eigen::Matrix<double, 12, 3> eliminated = colour_block.ldlt().solve(coupling.transpose()).transpose();
  TagNormalEquations result;
  result.H = G.block<12, 12>(0, 0) - eliminated * coupling.transpose();
  result.g = G.block<12, 1>(0, 15) - eliminated * G.block<3, 1>(12, 15);
  return result;
}

}  // namespace apriltrack
