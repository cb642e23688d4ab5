#include "turn_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/geometry/rotation.h"
#include "small_picture.h"

namespace apriltrack {
namespace {

constexpr int kMaxSteps = 8;
constexpr double kSettled_rad = 1e-3;
constexpr int kStride = 4;  // every fourth pixel, in a pattern
constexpr float kLeastDepth = 0.1F;
constexpr float kLeastScale = 1e-4F;  // a fortieth of a grey level: two pictures may be the same

/// Turn, gain and offset; then the residual.
constexpr int kUnknowns = 5;
using Moments = Eigen::Matrix<float, kUnknowns + 1, kUnknowns + 1>;
/// Rows filled up to what vectors hold.
constexpr int kPadded = 8;
using Row = Eigen::Matrix<float, kPadded, 1>;

/// Sums over the pixels that both pictures show.
struct TurnSums {
  /// Weighted, of the derivatives and the residual.
  Eigen::Matrix<float, kPadded, kUnknowns + 1> moments = Eigen::Matrix<float, kPadded, kUnknowns + 1>::Zero();
  float weight = 0.0F;
  float n = 0.0F, a = 0.0F, b = 0.0F, aa = 0.0F, bb = 0.0F, ab = 0.0F;  ///< Of both pictures' light.
  int num_pixels = 0;                                                   ///< All of `now`'s.

  double residual2() const { return static_cast<double>(moments(kUnknowns, kUnknowns)); }
  double rms() const { return std::sqrt(residual2() / std::max(1e-9, static_cast<double>(weight))); }
  double correlation() const {
    const float of_a = aa - a * a / n, of_b = bb - b * b / n;
    return of_a > 0.0F && of_b > 0.0F ? static_cast<double>((ab - a * b / n) / std::sqrt(of_a * of_b)) : 0.0;
  }
};

struct TurnState {
  Eigen::Quaterniond R_before_now;
  float gain = 1.0F, offset = 0.0F;
};

/// scale: of residuals that count a quarter.
TurnSums sums_at(const TurnedPictures& pictures, const TurnState& state, float scale) {
  const auto& [before, now, focal_px] = pictures;
  const Eigen::Matrix3f R = state.R_before_now.toRotationMatrix().cast<float>();
  const float cx = 0.5F * static_cast<float>(now.width() - 1),
              cy = 0.5F * static_cast<float>(now.height() - 1);
  TurnSums sums;
  for (int y = 0; y < now.height(); ++y) {
    for (int x = (2 * y) % kStride + (y / 2) % 2; x < now.width(); x += kStride) {
      ++sums.num_pixels;
      const float here = now(x, y);
      const Eigen::Vector3f ray((static_cast<float>(x) - cx) / focal_px,
                                (static_cast<float>(y) - cy) / focal_px, 1.0F);
      const Eigen::Vector3f there = R * ray;
      if (there.z() < kLeastDepth) continue;
      const float u = there.x() / there.z(), v = there.y() / there.z();
      Eigen::Vector2f slope;
      const float light = light_at(before, focal_px * u + cx, focal_px * v + cy, &slope);
      if (std::isnan(light) || std::isnan(here)) continue;
      const Eigen::Vector3f by_there =
          focal_px / there.z() * Eigen::Vector3f(slope.x(), slope.y(), -slope.x() * u - slope.y() * v);
      const float residual = light - state.gain * here - state.offset;
      const Eigen::Vector3f by_ray = R.transpose() * by_there;
      const Eigen::Vector3f by_turn = ray.cross(by_ray);
      Row row;
      row << by_turn.x(), by_turn.y(), by_turn.z(), -here, -1.0F, residual, 0.0F, 0.0F;
      const float ratio = residual / scale, root = 1.0F / (1.0F + ratio * ratio);
      const float weight = root * root;  // Geman and McClure's
      for (int k = 0; k <= kUnknowns; ++k) sums.moments.col(k) += (weight * row[k]) * row;
      sums.weight += weight;
      sums.n += 1.0F;
      sums.a += light;
      sums.b += here;
      sums.aa += light * light;
      sums.bb += here * here;
      sums.ab += light * here;
    }
  }
  return sums;
}

}  // namespace

FittedTurn fit_turn(const TurnedPictures& pictures, const Eigen::Quaterniond& start) {
  using Matrix5d = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  TurnState state{start};
  FittedTurn fit;
  float scale = std::numeric_limits<float>::infinity();
  for (int step = 0;; ++step) {
    const TurnSums sums = sums_at(pictures, state, scale);
    const Eigen::Matrix<double, kUnknowns + 1, kUnknowns + 1> moments =
        Moments(sums.moments.topRows<kUnknowns + 1>()).cast<double>();
    Matrix5d H = moments.topLeftCorner<kUnknowns, kUnknowns>();
    H.diagonal().array() += 1e-9 * H.trace() + 1e-12;
    const Eigen::LDLT<Matrix5d> factor(H);
    const Eigen::Matrix<double, kUnknowns, 1> move = -factor.solve(moments.col(kUnknowns).head<kUnknowns>());
    if (!move.allFinite() || sums.n < 2.0F * kUnknowns) return {};
    fit.R_before_now = state.R_before_now;
    fit.common_share = static_cast<double>(sums.n) / sums.num_pixels;
    fit.correlation = state.gain > 0.0F ? sums.correlation() : 0.0;
    fit.sigma_rad =
        sums.rms() * std::sqrt(factor.solve(Matrix5d::Identity()).diagonal().head<3>().maxCoeff());
    if (step == kMaxSteps || (step > 1 && move.head<3>().norm() < kSettled_rad)) return fit;
    state.R_before_now = (state.R_before_now * rotation_exp(move.head<3>())).normalized();
    state.gain += static_cast<float>(move[3]);
    state.offset += static_cast<float>(move[4]);
    scale = std::max(kLeastScale, static_cast<float>(2.0 * sums.rms()));
  }
}

}  // namespace apriltrack
