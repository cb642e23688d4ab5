#include "edge_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "apriltrack/base/geman_mcclure.h"
#include "apriltrack/base/normal_table.h"

namespace apriltrack {
namespace {

enum Parameter { kOffset, kSlope, kBend, kLogSigma, kInner, kOuter, kInnerTilt, kOuterTilt, kNumParameters };
using Parameters = Eigen::Matrix<double, kNumParameters, 1>;
using Information = Eigen::Matrix<double, kNumParameters, kNumParameters>;

constexpr int kMaxIterations = 15;
constexpr std::size_t kMinSamples = 24;
constexpr double kMinSigma_px = 0.35;  // a pixel's own box has 0.29
constexpr double kMaxSigma_px = 30.0;
/// Levels may tilt along the edge by this part of the contrast (one standard deviation).
constexpr double kTiltPrior = 0.15;
/// Samples are interpolated from the same pixels, and what is wrong with them (steps of the pixel grid, JPEG)
/// does not average out like noise: this many count as one.
constexpr double kSamplesPerDatum = 4.0;
/// Residuals beyond this part of the contrast are some other thing's edge.
constexpr double kMinOutlierScale = 0.06;
/// Of the residuals' root mean square.
constexpr double kOutlierScale = 4.0;

/// What a profile shows, blurred, at `across` pixels from where the edge is taken to lie.
struct BlurredLevel {
  double level;     ///< 0 inside to 1 outside.
  double by_z;      ///< For a common shift of all changes, in sigmas.
  double by_sigma;  ///< By log sigma.
};

BlurredLevel blurred_level(const NormalTable& normal, const EdgeProfile& profile, double across,
                           double inverse_sigma) {
  BlurredLevel sum{profile.innermost_level, 0.0, 0.0};
  for (int i = 0; i < profile.num_changes; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double z = (across - profile.position_px[k]) * inverse_sigma;
    const NormalValue value = normal.at(z);
    sum.level += profile.height[k] * value.below;
    sum.by_z += profile.height[k] * value.density;
    sum.by_sigma -= profile.height[k] * value.density * z;
  }
  return sum;
}

/// Levels from the means of either side, which blur and data bits only bring nearer to each other.
std::optional<Parameters> initial_parameters(const std::vector<EdgeSample>& samples,
                                             const EdgeFitOptions& options) {
  double sums[2] = {0.0, 0.0};
  int counts[2] = {0, 0};
  for (const EdgeSample& sample : samples) {
    const int side = sample.across > 0.0 ? 1 : 0;
    sums[side] += sample.light;
    ++counts[side];
  }
  if (counts[0] == 0 || counts[1] == 0) return std::nullopt;
  Parameters p = Parameters::Zero();
  p[kLogSigma] = std::log(options.initial_sigma_px);
  p[kInner] = sums[0] / counts[0];
  p[kOuter] = sums[1] / counts[1];
  if (options.polarity * (p[kOuter] - p[kInner]) <= 0.0) return std::nullopt;
  return p;
}

/// As found before. The line that it is about now joins the corners found then, so that the bend alone leads
/// off it.
Parameters parameters_of(const FittedEdge& before) {
  Parameters p;
  p << -2.0 / 3.0 * before.bend, 0.0, before.bend, std::log(before.sigma_px), before.inner_light,
      before.outer_light, before.inner_tilt, before.outer_tilt;
  return p;
}

/// Along one column across the edge, derivatives are four numbers, each times powers of the column's place:
/// by the offset, by log sigma, and by both levels.
struct ColumnSums {
  enum Kind { kByOffset, kBySigma, kByInner, kByOuter, kNumKinds };
  using Vector = Eigen::Matrix<double, kNumKinds, 1>;
  Eigen::Matrix<double, kNumKinds, kNumKinds> information =
      Eigen::Matrix<double, kNumKinds, kNumKinds>::Zero();
  Vector gradient = Vector::Zero();
};

struct NormalEquations {
  Information information = Information::Zero();
  Parameters gradient = Parameters::Zero();
  double weighted_squares = 0.0;
  double weights = 0.0;

  void add(const ColumnSums& column, double along, double bend_basis) {
    using C = ColumnSums;
    constexpr C::Kind kKinds[] = {C::kByOffset, C::kByOffset, C::kByOffset, C::kBySigma,
                                  C::kByInner,  C::kByOuter,  C::kByInner,  C::kByOuter};
    const double factors[] = {1.0, along, bend_basis, 1.0, 1.0, 1.0, along, along};
    for (int i = 0; i < kNumParameters; ++i) {
      for (int k = 0; k <= i; ++k)
        information(i, k) += factors[i] * factors[k] * column.information(kKinds[i], kKinds[k]);
      gradient[i] += factors[i] * column.gradient[kKinds[i]];
    }
  }
};

/// Samples come column by column.
NormalEquations linearise(const std::vector<EdgeSample>& samples, const std::vector<EdgeProfile>& profiles,
                          const Parameters& p, double outlier_scale) {
  const NormalTable& normal = NormalTable::get();
  const double inverse_sigma = std::exp(-p[kLogSigma]);
  const GemanMcClure error(outlier_scale);
  NormalEquations equations;
  for (auto sample = samples.begin(); sample != samples.end();) {
    const EdgeProfile& profile = profiles[sample->profile];
    const double t = sample->along;
    const double bend_basis = t * t - 1.0 / 3.0;
    const double edge = p[kOffset] + p[kSlope] * t + p[kBend] * bend_basis;
    const double inner = p[kInner] + p[kInnerTilt] * t;
    const double contrast = p[kOuter] + p[kOuterTilt] * t - inner;
    ColumnSums column;
    for (const std::size_t of = sample->profile; sample != samples.end() && sample->profile == of; ++sample) {
      const BlurredLevel at = blurred_level(normal, profile, sample->across - edge, inverse_sigma);
      const double r = sample->light - (inner + contrast * at.level);
      const double weight = error.weight(r * r);
      const ColumnSums::Vector derivative(-contrast * at.by_z * inverse_sigma, contrast * at.by_sigma,
                                          1.0 - at.level, at.level);
      column.information += (weight * derivative) * derivative.transpose();
      column.gradient += (weight * r) * derivative;
      equations.weighted_squares += weight * r * r;
      equations.weights += weight;
    }
    equations.add(column, t, bend_basis);
  }
  return equations;
}

/// Gaussian priors that keep the bend and the tilts at zero where the samples do not say otherwise.
void add_priors(double variance, double contrast, double bend_prior_px, const Parameters& p,
                NormalEquations* equations) {
  const auto add = [&](Parameter index, double sigma) {
    const double weight = variance / (sigma * sigma);
    equations->information(index, index) += weight;
    equations->gradient[index] -= weight * p[index];
  };
  add(kBend, bend_prior_px);
  add(kInnerTilt, kTiltPrior * contrast);
  add(kOuterTilt, kTiltPrior * contrast);
}

}  // namespace

std::optional<FittedEdge> fit_edge(const std::vector<EdgeSample>& samples,
                                   const std::vector<EdgeProfile>& profiles, const EdgeFitOptions& options) {
  if (samples.size() < kMinSamples) return std::nullopt;
  const std::optional<Parameters> start =
      options.before ? parameters_of(*options.before) : initial_parameters(samples, options);
  if (!start) return std::nullopt;
  Parameters p = *start;

  double outlier_scale = std::abs(p[kOuter] - p[kInner]);  // nearly plain least squares at first
  if (options.before)
    outlier_scale *= std::max(kOutlierScale * options.before->residual_rms, kMinOutlierScale);
  const int min_iterations = options.before ? 2 : 5;
  double variance = 0.0;
  NormalEquations equations;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    equations = linearise(samples, profiles, p, outlier_scale);
    const double contrast = std::abs(p[kOuter] - p[kInner]);
    variance = std::max(equations.weighted_squares / equations.weights, 1e-6 * contrast * contrast) *
               kSamplesPerDatum;
    add_priors(variance, contrast, options.bend_prior_px, p, &equations);
    equations.information.diagonal() *= 1.0 + 1e-4;
    Parameters step = equations.information.selfadjointView<Eigen::Lower>().ldlt().solve(equations.gradient);
    if (!step.allFinite()) return std::nullopt;
    step[kLogSigma] = std::clamp(step[kLogSigma], -0.5, 0.5);
    p += step;
    p[kLogSigma] = std::clamp(p[kLogSigma], std::log(kMinSigma_px), std::log(kMaxSigma_px));
    if (options.polarity * (p[kOuter] - p[kInner]) <= 0.0) return std::nullopt;
    outlier_scale = std::max(kOutlierScale * std::sqrt(equations.weighted_squares / equations.weights),
                             kMinOutlierScale * contrast);
    if (iteration + 1 >= min_iterations &&
        std::abs(step[kOffset]) + std::abs(step[kSlope]) + std::abs(step[kBend]) < 2e-3)
      break;
  }

  FittedEdge edge;
  edge.offset = p[kOffset];
  edge.slope = p[kSlope];
  edge.bend = p[kBend];
  edge.sigma_px = std::exp(p[kLogSigma]);
  edge.inner_light = p[kInner];
  edge.outer_light = p[kOuter];
  edge.inner_tilt = p[kInnerTilt];
  edge.outer_tilt = p[kOuterTilt];
  edge.residual_rms =
      std::sqrt(equations.weighted_squares / equations.weights) / std::abs(p[kOuter] - p[kInner]);
  const Information full = equations.information.selfadjointView<Eigen::Lower>();
  const Parameters column = full.ldlt().solve(Parameters::Unit(kOffset));
  edge.sigma_offset_px = std::sqrt(std::max(0.0, variance * column[kOffset]));
  return edge;
}

}  // namespace apriltrack
