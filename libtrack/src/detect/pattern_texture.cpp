#include "pattern_texture.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace apriltrack {
namespace {

/// In sigmas of the blur where it is least: what splines between such nodes leave out is 1e-3 of the
/// contrast.
constexpr double kStepInSigmas = 1.2;
/// Beyond the print, in sigmas: farther out pixels are not asked.
constexpr double kReachInSigmas = 1.5;
/// So many nodes take as long to fill as a pixel to ask without them.
constexpr double kNodesPerPixel = 8.0;

/// Cubic B-spline between four nodes at the share t of a step after the second, and its derivatives.
struct SplineWeights {
  Eigen::Vector4d value, slope, bend;

  explicit SplineWeights(double t) {
    const double s = 1.0 - t;
    value = Eigen::Vector4d(s * s * s, 4.0 - 6.0 * t * t + 3.0 * t * t * t,
                            4.0 - 6.0 * s * s + 3.0 * s * s * s, t * t * t) /
            6.0;
    slope = Eigen::Vector4d(-0.5 * s * s, t * (1.5 * t - 2.0), s * (2.0 - 1.5 * s), 0.5 * t * t);
    bend = Eigen::Vector4d(s, 3.0 * t - 2.0, 3.0 * s - 2.0, t);
  }
};

}  // namespace

std::optional<PatternTexture> PatternTexture::of(const BlurredPattern& pattern,
                                                 const Eigen::Matrix2d& covariance, std::size_t num_asked) {
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()[0];
  if (!(least > 0.0)) return std::nullopt;
  const double step = kStepInSigmas * std::sqrt(least);
  const double reach =
      pattern.half_extent() + kReachInSigmas * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  const double nodes = std::ceil(2.0 * reach / step) + 4.0;
  if (!(nodes * nodes <= kNodesPerPixel * static_cast<double>(num_asked))) return std::nullopt;
  PatternTexture texture;
  texture.covariance_ = covariance;
  texture.num_nodes_ = static_cast<int>(nodes);
  texture.begin_ = -0.5 * (texture.num_nodes_ - 1) * step;
  texture.per_step_ = 1.0 / step;
  const Eigen::Matrix2d narrower = covariance - step * step / 3.0 * Eigen::Matrix2d::Identity();
  const Eigen::VectorXd places =
      Eigen::VectorXd::LinSpaced(texture.num_nodes_, texture.begin_, -texture.begin_);
  BlurredPattern::Grid grid = pattern.on_grid(places, PatternBlur::of(narrower));
  texture.light_ = std::move(grid.light);
  texture.known_ = std::move(grid.known);
  texture.beyond_ = std::move(grid.beyond);
  return texture;
}

PatternSample PatternTexture::at(double u, double v, const Eigen::Matrix2d& covariance) const {
  const double last = num_nodes_ - 3;
  const double x = std::clamp((u - begin_) * per_step_, 1.0, last);
  const double y = std::clamp((v - begin_) * per_step_, 1.0, last);
  const auto column = std::min(static_cast<Eigen::Index>(x), static_cast<Eigen::Index>(num_nodes_ - 4));
  const auto row = std::min(static_cast<Eigen::Index>(y), static_cast<Eigen::Index>(num_nodes_ - 4));
  const SplineWeights along_u(x - static_cast<double>(column)), along_v(y - static_cast<double>(row));
  const Eigen::Matrix4d near = light_.block<4, 4>(row - 1, column - 1);
  const Eigen::Vector4d value = near * along_u.value, slope = near * along_u.slope;
  PatternSample sample;
  sample.by_u = along_v.value.dot(slope) * per_step_;
  sample.by_v = along_v.slope.dot(value) * per_step_;
  const double per_step2 = per_step_ * per_step_;
  sample.by_uu = along_v.value.dot(near * along_u.bend) * per_step2;
  sample.by_uv = along_v.slope.dot(slope) * per_step2;
  sample.by_vv = along_v.bend.dot(value) * per_step2;
  sample.light = along_v.value.dot(value) + sample.by_covariance(covariance - covariance_);
  const Eigen::Vector4d of_u = beyond_.middleCols<4>(column - 1) * along_u.value;
  const Eigen::Vector4d of_v = beyond_.middleCols<4>(row - 1) * along_v.value;
  sample.beyond = {of_u[kLeftSide], of_u[kRightSide], of_v[kTopSide], of_v[kBottomSide]};
  sample.known =
      known_.size() > 0
          ? along_v.value.dot(known_.block<4, 4>(row - 1, column - 1) * along_u.value)
          : (1.0 - of_u[kLeftSide] - of_u[kRightSide]) * (1.0 - of_v[kTopSide] - of_v[kBottomSide]);
  return sample;
}

}  // namespace apriltrack
