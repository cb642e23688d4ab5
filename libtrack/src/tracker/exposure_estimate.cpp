#include "exposure_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

const double kLogRange = std::log(25.0);
/// Observations of a second or two: what came before loses its weight.
constexpr double kKept = 1.0 - 1.0 / 60.0;
/// Observations that say nothing: a turn between frames, a false pose.
constexpr double kOutliers = 0.1;
const double kLogOutlierRange = std::log(100.0);
/// What is told is off by any factor now and then: a file of another recording.
constexpr double kGrossErrors = 0.03;
constexpr double kGrossSigma = 0.7;

double gaussian(double off, double variance) {
  return std::exp(-0.5 * off * off / variance) / std::sqrt(2.0 * M_PI * variance);
}

}  // namespace

ExposureEstimate::ExposureEstimate(double sigma)
    : limit_(std::numeric_limits<double>::infinity()), sigma_(sigma) {
  APRILTRACK_CHECK(sigma > 0.0, "an exposure's standard deviation must be > 0");
  for (Eigen::Index i = 0; i < kSize; ++i) {
    const double log_factor = kLogRange * (2.0 * static_cast<double>(i) / (kSize - 1) - 1.0);
    log_prior_[i] = std::log((1.0 - kGrossErrors) * gaussian(log_factor, sigma * sigma) +
                             kGrossErrors * gaussian(log_factor, kGrossSigma * kGrossSigma));
  }
}

void ExposureEstimate::observe(const PathRatio& seen) {
  if (!(seen.ratio > 0.0 && seen.variance > 0.0)) return;
  has_observed_ = true;
  const double log_ratio = std::log(seen.ratio);
  const double by_chance = kOutliers / kLogOutlierRange;
  for (Eigen::Index i = 0; i < kSize; ++i) {
    const double log_factor = kLogRange * (2.0 * static_cast<double>(i) / (kSize - 1) - 1.0);
    const double likelihood = gaussian(log_ratio - log_factor, seen.variance);
    log_seen_[i] = kKept * log_seen_[i] + std::log((1.0 - kOutliers) * likelihood + by_chance);
  }
  log_seen_ -= log_seen_.maxCoeff();
  summarise();
}

void ExposureEstimate::limit(double factor) {
  APRILTRACK_CHECK(factor > 0.0, "an exposure's limit must be > 0");
  limit_ = factor;
  if (has_observed_) {
    summarise();
  } else {
    factor_ = std::min(1.0, limit_);
  }
}

void ExposureEstimate::summarise() {
  const Eigen::Array<double, kSize, 1> log_density = log_prior_ + log_seen_;
  const double log_limit = std::log(limit_);
  double sum = 0.0, first = 0.0, second = 0.0;
  const double highest = log_density.maxCoeff();
  for (Eigen::Index i = 0; i < kSize; ++i) {
    const double log_factor = kLogRange * (2.0 * static_cast<double>(i) / (kSize - 1) - 1.0);
    if (log_factor > log_limit) break;
    const double weight = std::exp(log_density[i] - highest);
    sum += weight;
    first += weight * log_factor;
    second += weight * log_factor * log_factor;
  }
  if (!(sum > 0.0)) return;
  const double mean = first / sum;
  factor_ = std::exp(mean);
  sigma_ = std::sqrt(std::max(0.0, second / sum - mean * mean));
}

}  // namespace apriltrack
