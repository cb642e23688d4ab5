#include "paper_references.h"

#include <array>
#include <optional>

#include "apriltrack/geometry/homography.h"

namespace apriltrack {
namespace {

/// Of a tag's patch: less of it in the image is not evidence.
constexpr double kMinSeenShare = 0.25;

/// (u, v, 1) of the tag's plane, in half tag sizes, to rays, from the four detected corners alone (the
/// paper's reference homography); nullopt when they do not determine it.
std::optional<Eigen::Matrix3d> rays_from_plane(const CameraModel& model, const TagObservation& observation) {
  std::array<Eigen::Vector2d, kNumCorners> plane, rays;
  const auto corners_tag = tag_corners(2.0);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const auto ray = model.unproject(observation.corners_px[i]);
    if (!ray || !(ray->z() > 0.0)) return std::nullopt;
    plane[i] = corners_tag[i].head<2>();
    rays[i] = ray->head<2>() / ray->z();
  }
  return estimate_homography(plane, rays);
}

}  // namespace

void PaperReferences::renew(const ImageView<const float>& grey, const std::vector<Detection>& detections) {
  is_detected_.assign(map_.tags.size(), false);
  std::vector<double> patch(grid_.num_samples());
  constexpr double kAnySigma_px = 1.0;  // patches do not depend on the noise of corners
  for (const TagObservation& observation :
       observe_mapped_tags(map_, index_, model_, detections, kAnySigma_px)) {
    const auto index = static_cast<std::size_t>(observation.tag_index);
    const auto H = rays_from_plane(model_, observation);
    if (observation.is_repeated || !H) continue;
    if (sample_patch(grey, model_, *H, grid_, patch) < PatchMatch::kMinSamples) continue;
    likelihood_.set_reference(index, patch);
    is_detected_[index] = true;
  }
}

PaperEvidence PaperReferences::weigh(const JointScores& scores, std::size_t index,
                                     double min_correlation) const {
  PaperEvidence evidence;
  double sum = 0.0, total_share = 0.0;
  for (std::size_t k = 0; k < scores.num_tags; ++k) {
    const TagScore& score = scores.tag(index, k);
    if (score.seen_share < kMinSeenShare) continue;
    sum += score.seen_share * score.correlation;
    total_share += score.seen_share;
    const bool agrees = score.correlation >= min_correlation;
    evidence.num_agreeing += agrees ? 1 : 0;
    evidence.has_detected = evidence.has_detected || (agrees && is_detected_[k]);
  }
  if (total_share > 0.0) evidence.mean_correlation = sum / total_share;
  return evidence;
}

void PaperReferences::discard(const JointScores& scores, std::size_t index, double least_correlation) {
  for (std::size_t k = 0; k < scores.num_tags; ++k) {
    const TagScore& score = scores.tag(index, k);
    const bool is_judged = score.seen_share >= kMinSeenShare;
    if (is_judged && score.correlation < least_correlation) likelihood_.clear_reference(k);
  }
}

void PaperReferences::forget() {
  for (std::size_t k = 0; k < map_.tags.size(); ++k) likelihood_.clear_reference(k);
}

}  // namespace apriltrack
