#include "tag_faults.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "apriltrack/geometry/rounded_rotation.h"
#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_key_fault.h"
#include "family_source.h"

namespace apriltrack {
namespace {

constexpr double kMaxSize_m = 100.0;  // as --tag-size: beyond, it was given in millimetres
/// Northings of UTM go up to this, coordinates of an Earth-centred frame to 6.4e6 m; doubles still resolve 2
/// nm there. What is larger is no place, and squares of it are soon no number.
constexpr double kMaxCoordinate_m = 1e7;
/// Quaternions written with four decimals are as far from unit length as this; what is farther off is a
/// mistake.
constexpr double kMaxQuaternionNormError = 1e-3;
/// Of covariances scaled to unit diagonal: what rounding to six digits leaves.
constexpr double kCovarianceTolerance = 1e-6;

}  // namespace

std::optional<std::string> fault_of_size(double size_m) {
  if (size_m > 0.0 && size_m <= kMaxSize_m) return std::nullopt;  // false for NaN
  return fmt::format("must be > 0 and at most {:g} (is {}); metres, the edge of the detected square",
                     kMaxSize_m, size_m);
}

std::optional<std::string> fault_of_coordinate(double position_m) {
  if (std::abs(position_m) <= kMaxCoordinate_m) return std::nullopt;  // false for NaN
  return fmt::format("must lie in [{0:g}, {1:g}] metres (is {2:g})", -kMaxCoordinate_m, kMaxCoordinate_m,
                     position_m);
}

std::optional<std::string> fault_of_quaternion(const Eigen::Quaterniond& rotation) {
  if (is_rounded_rotation(rotation, kMaxQuaternionNormError)) return std::nullopt;
  return fmt::format("must be a quaternion of length 1, within {} (has length {:.6g})",
                     kMaxQuaternionNormError, rotation.coeffs().stableNorm());
}

std::optional<std::string> fault_of_id(const TagKey& key) {
  const int num_codes = TagFamily::get(key.family).num_codes();
  if (key.id >= 0 && key.id < num_codes) return std::nullopt;
  return fmt::format("{} has ids 0 to {} (is {})", key.family, num_codes - 1, key.id);
}

std::optional<std::string> fault_of_key(const TagKey& key) {
  return TagFamily::is_known(key.family) ? fault_of_id(key) : unknown_family_message(key.family);
}

std::optional<std::string> fault_of_covariance(const Matrix6d& covariance) {
  for (int i = 0; i < 36; ++i) {
    const double value = covariance(i / 6, i % 6);
    if (!std::isfinite(value))
      return fmt::format("must be finite (row {}, column {} is {})", i / 6, i % 6, value);
  }
  // Square metres and square radians are compared after scaling each row and column to unit variance.
  Vector6d inverse_sigma;
  for (int i = 0; i < 6; ++i) {
    const double variance = covariance(i, i);
    if (variance < 0.0) return fmt::format("variance {} must be >= 0 (is {})", i, variance);
    inverse_sigma[i] = variance > 0.0 ? 1.0 / std::sqrt(variance) : 1.0;
  }
  const Matrix6d correlation = inverse_sigma.asDiagonal() * covariance * inverse_sigma.asDiagonal();
  const double asymmetry = (correlation - correlation.transpose()).cwiseAbs().maxCoeff();
  if (!(asymmetry <= kCovarianceTolerance)) {
    return fmt::format("must be symmetric (scaled to unit variances, two mirrored entries differ by {:.3g})",
                       asymmetry);
  }
  const Matrix6d lifted = correlation + kCovarianceTolerance * Matrix6d::Identity();
  if (Eigen::LLT<Matrix6d>(lifted).info() != Eigen::Success)
    return "must be positive semidefinite: some combination of its six errors has a negative variance";
  return std::nullopt;
}

}  // namespace apriltrack
