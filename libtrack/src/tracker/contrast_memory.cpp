#include "contrast_memory.h"

#include <cmath>

namespace apriltrack {
namespace {

/// Light, shadow, flicker and automatic exposure change a tag's contrast, but seldom by this factor at once:
/// by 1.22 in 99.5 % of a room's blurred views, by 1.32 at most.
constexpr double kMaxFactor = 1.4;
/// More for what has turned since: of a matt surface at the angle a to the light, d log(cos a) = -tan(a) da,
/// and one is the tangent of 45 degrees.
constexpr double kLogPerRadian = 1.0;
/// Tags that are not well explained say little of their contrast.
constexpr double kMinTrustedCorrelation = 0.9;

}  // namespace

void ContrastMemory::remember(const std::vector<TagEvidence>& tags, const Eigen::Quaterniond& R_light_map) {
  for (const TagEvidence& tag : tags) {
    if (tag.clean_correlation() < kMinTrustedCorrelation) continue;
    seen_.insert_or_assign(tag.tag_index, Seen{tag.contrast, R_light_map});
  }
}

void ContrastMemory::doubt(std::vector<TagEvidence>& tags, const Eigen::Quaterniond& R_light_map) const {
  for (TagEvidence& tag : tags) {
    const auto found = seen_.find(tag.tag_index);
    if (found == seen_.end()) continue;
    const Seen& seen = found->second;
    const double factor =
        kMaxFactor * std::exp(kLogPerRadian * seen.R_light_map.angularDistance(R_light_map));
    const bool is_usual = tag.contrast < factor * seen.contrast && tag.contrast > seen.contrast / factor;
    if (!is_usual) tag.correlation = 0.0;
  }
}

}  // namespace apriltrack
