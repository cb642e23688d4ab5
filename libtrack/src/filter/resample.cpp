#include "apriltrack/filter/resample.h"

#include <algorithm>

#include "apriltrack/base/check.h"

namespace apriltrack {
namespace {

/// points: ascending, in [0, 1).
std::vector<std::size_t> invert_distribution(std::span<const double> weights,
                                             const std::vector<double>& points) {
  APRILTRACK_CHECK(!weights.empty(), "there must be a particle to resample");
  std::vector<std::size_t> indices;
  indices.reserve(points.size());
  // Rounding may leave the sum short of 1; what has no weight must not live on for that.
  std::size_t last = weights.size() - 1;
  while (last > 0 && !(weights[last] > 0.0)) --last;
  std::size_t i = 0;
  double cumulated = weights[0];
  for (const double point : points) {
    while (point >= cumulated && i < last) cumulated += weights[++i];
    indices.push_back(i);
  }
  return indices;
}

}  // namespace

std::vector<std::size_t> resample_multinomial(std::span<const double> weights, std::size_t count,
                                              RandomStream& random) {
  std::vector<double> points(count);
  std::generate(points.begin(), points.end(), [&] { return random.uniform(); });
  std::sort(points.begin(), points.end());
  return invert_distribution(weights, points);
}

}  // namespace apriltrack
