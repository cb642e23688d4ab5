#include "tag_observation.h"

#include <cmath>
#include <set>

namespace apriltrack {

namespace {

std::optional<double> claimed_sigma_px(const Detection& detection) {
  if (!detection.covariance_px2) return std::nullopt;
  return std::sqrt(detection.covariance_px2->trace() / (2.0 * kNumCorners));
}

}  // namespace

std::vector<TagObservation> observe_mapped_tags(const TagMap& map, const TagIndex& index,
                                                const CameraModel& model,
                                                const std::vector<Detection>& detections) {
  std::vector<TagObservation> observations;
  for (const Detection& detection : detections) {
    const auto position = index.find(detection.tag);
    if (!position) continue;
    const MapTag* tag = &map.tags[*position];
    const auto rays = corner_rays(model, detection.corners_px);
    if (!rays) continue;
    TagObservation observation{.tag = tag,
                               .tag_index = static_cast<int>(*position),
                               .corners_map = corners_in_map(*tag),
                               .corners_px = detection.corners_px,
                               .planar_poses = solve_planar_pnp(*rays, tag->size_m),
                               .corrected_bits = detection.hamming.value_or(0),
                               .claimed_sigma_px = claimed_sigma_px(detection),
                               .is_repeated = false};
    for (TagObservation& other : observations) {
      if (other.tag == tag) other.is_repeated = observation.is_repeated = true;
    }
    observations.push_back(observation);
  }
  return observations;
}

int count_tags(const std::vector<TagObservation>& observations) {
  std::set<const MapTag*> tags;
  for (const TagObservation& observation : observations) tags.insert(observation.tag);
  return static_cast<int>(tags.size());
}

int count_tags(const std::vector<const TagObservation*>& observations) {
  std::set<const MapTag*> tags;
  for (const TagObservation* observation : observations) tags.insert(observation->tag);
  return static_cast<int>(tags.size());
}

}  // namespace apriltrack
