#include "tag_observation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <set>

#include "corner_noise.h"

namespace apriltrack {

namespace {

/// Symmetric, so that no corner comes before another.
CornerCovariance whitening_of(const CornerCovariance& covariance_px2) {
  if (covariance_px2.isDiagonal(0.0))
    return covariance_px2.diagonal().cwiseSqrt().cwiseInverse().asDiagonal().toDenseMatrix();
  return Eigen::SelfAdjointEigenSolver<CornerCovariance>(covariance_px2).operatorInverseSqrt();
}

void set_whitening(TagObservation& observation) {
  observation.whitening_per_px = whitening_of(observation.covariance_px2);
  observation.log_determinant = observation.covariance_px2.ldlt().vectorD().array().log().sum();
}

bool is_positive(const CornerCovariance& covariance_px2) {
  return covariance_px2.allFinite() && covariance_px2.llt().info() == Eigen::Success;
}

}  // namespace

TagObservation with_further_noise(TagObservation observation, double sigma_px) {
  observation.covariance_px2.diagonal().array() += sigma_px * sigma_px;
  set_whitening(observation);
  return observation;
}

std::vector<TagObservation> observe_mapped_tags(const TagMap& map, const TagIndex& index,
                                                const CameraModel& model,
                                                const std::vector<Detection>& detections,
                                                double sharp_sigma_px) {
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
                               .claimed_covariance_px2 = detection.covariance_px2,
                               .covariance_px2 = still_corner_covariance_px2(detection, sharp_sigma_px),
                               .whitening_per_px = CornerCovariance::Identity(),
                               .log_determinant = 0.0,
                               .is_repeated = false};
    if (!is_positive(observation.covariance_px2)) continue;
    set_whitening(observation);
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
