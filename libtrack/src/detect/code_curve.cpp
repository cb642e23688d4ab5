#include "code_curve.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace apriltrack {
namespace {

constexpr double kFullScale = 255.0;
/// A gamma curve is upright at black: below this grey level it goes on straight.
constexpr std::size_t kDarkestCode = 2;
constexpr double kLeastRise = 1e-6;
/// Of tags, where exposure is right.
constexpr int kFirstCode = 20, kLastCode = 235;

}  // namespace

CodeCurve CodeCurve::gamma(double exponent) {
  CodeCurve curve(ResponseCurve::gamma(exponent));
  curve.exponent_ = exponent;
  return curve;
}

CodeCurve::Sample CodeCurve::at(double light) const {
  const auto& table = response_.linear_light();
  const auto above = std::upper_bound(table.begin() + kDarkestCode + 1, table.end() - 1, light);
  const double low = *(above - 1), rise = std::max(*above - low, kLeastRise);
  const double code = (static_cast<double>(above - 1 - table.begin()) + (light - low) / rise) / kFullScale;
  Sample sample{code, 1.0 / (kFullScale * rise), 0.0};
  if (exponent_ > 0.0) {
    const double inside = std::clamp(code, static_cast<double>(kDarkestCode) / kFullScale, 1.0);
    sample.by_exponent = -inside * std::log(inside) / exponent_;
  }
  return sample;
}

double CodeCurve::light(double code) const {
  const auto& table = response_.linear_light();
  const double place = std::clamp(code, 0.0, 1.0) * kFullScale;
  const std::size_t below = std::min(static_cast<std::size_t>(place), table.size() - 2);
  return table[below] + (place - static_cast<double>(below)) * (table[below + 1] - table[below]);
}

double nearest_exponent(const ResponseCurve& response) {
  constexpr int kNumCodes = kLastCode - kFirstCode + 1;
  Eigen::VectorXd light(kNumCodes);
  Eigen::MatrixX2d basis(kNumCodes, 2);
  const auto error_of = [&](double exponent) {
    for (int i = 0; i < kNumCodes; ++i) {
      light[i] = response.linear_light()[static_cast<std::size_t>(kFirstCode + i)];
      basis.row(i) << std::pow((kFirstCode + i) / kFullScale, exponent), 1.0;
    }
    return (basis * basis.colPivHouseholderQr().solve(light) - light).squaredNorm();
  };
  double best = 1.0, least = std::numeric_limits<double>::infinity();
  for (int hundredths = 20; hundredths <= 500; ++hundredths) {
    const double error = error_of(0.01 * hundredths);
    if (error < least) {
      least = error;
      best = 0.01 * hundredths;
    }
  }
  return best;
}

}  // namespace apriltrack
