#include "assess/tag_flags.h"

#include <cmath>
#include <string>
#include <vector>

#include "assess/weak_directions.h"

namespace apriltrack {
namespace {

constexpr int kFewViews = 5;

bool is_loose(const Matrix6d& covariance, double size_m) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace()) > kWeakRotation_rad ||
         std::sqrt(covariance.topLeftCorner<3, 3>().trace()) > kWeakPosition * size_m;
}

}  // namespace

bool is_weak(const MapTag& tag, int views, const std::optional<Matrix6d>& by_noise,
             const std::optional<Matrix6d>& constrained) {
  if (constrained && !is_loose(*constrained, tag.size_m)) return false;
  return views < kFewViews || (by_noise && is_loose(*by_noise, tag.size_m));
}

void flag_weak(bool is_weak, TagStatistics& statistics) {
  std::erase(statistics.flags, std::string("weak"));
  if (is_weak) statistics.flags.insert(statistics.flags.begin(), "weak");
}

}  // namespace apriltrack
