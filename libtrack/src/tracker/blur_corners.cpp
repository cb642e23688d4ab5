#include "blur_corners.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace apriltrack {
namespace {

// Twice and more of what the detector's corners show against exact truth (0.08 px, 0.02 of the blur, heavy
// tails): the same pixels speak for themselves in the fit.
constexpr double kSharpFactor = 2.0;
constexpr double kSigmaPerBlur = 0.06;
constexpr double kUnseenSigma_px = 1.0;

double corner_sigma_px(const PhotometricWorld& world, const Eigen::Vector3d& point, const MotionState& state,
                       double exposure_s, double sharp_sigma_px) {
  const auto at = [&](double time_s) {
    return world.model.project(camera_from_map(pose_after(state, time_s), world.mode) * point);
  };
  const auto first = at(-0.5 * exposure_s), last = at(0.5 * exposure_s);
  if (!first || !last) return kUnseenSigma_px;
  return std::hypot(kSharpFactor * sharp_sigma_px, kSigmaPerBlur * (*last - *first).norm());
}

/// Whether the middle of the detection lies on the tag.
bool is_on_tag(const CameraModel& model, const Detection& detection, const Pose& T_camera_tag,
               double half_size_m) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : detection.corners_px) middle += corner / double{kNumCorners};
  const auto ray = model.unproject(middle);
  if (!ray) return false;
  const Pose T_tag_camera = T_camera_tag.inverse();
  const Eigen::Vector3d direction = T_tag_camera.rotation() * *ray;
  const Eigen::Vector3d& eye = T_tag_camera.translation();
  const double depth = -eye.z() / direction.z();
  const Eigen::Vector2d point = (eye + depth * direction).head<2>();
  return depth > 0.0 && point.cwiseAbs().maxCoeff() < half_size_m;
}

}  // namespace

std::vector<CornerObservation> corner_observations(const PhotometricWorld& world,
                                                   const std::vector<TagObservation>& observations,
                                                   const MotionState& state, double exposure_s,
                                                   double sharp_sigma_px) {
  std::vector<CornerObservation> corners;
  for (const TagObservation& observation : observations) {
    if (observation.corrected_bits > 0 || observation.is_repeated) continue;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector3d& point = observation.corners_map[i];
      corners.push_back({point, observation.corners_px[i],
                         corner_sigma_px(world, point, state, exposure_s, sharp_sigma_px)});
    }
  }
  return corners;
}

TagVotes count_votes(const PhotometricWorld& world, const std::vector<TagObservation>& observations,
                     const MotionState& state, double exposure_s, double sharp_sigma_px) {
  constexpr double kMaxSigmas = 4.0;
  constexpr double kSlack_px = 1.0;
  constexpr double kFarthest_px = 5.0;  // or a fast enough state would agree with any detection
  const Pose view = camera_from_map(state.pose, world.mode);
  std::set<const MapTag*> agreeing, contradicting;
  for (const TagObservation& observation : observations) {
    bool is_near = true;
    for (std::size_t i = 0; i < kNumCorners; ++i) {
      const Eigen::Vector3d& point = observation.corners_map[i];
      const auto pixel = world.model.project(view * point);
      const double sigma_px = corner_sigma_px(world, point, state, exposure_s, sharp_sigma_px);
      const double limit_px = std::min(kSlack_px + kMaxSigmas * sigma_px, kFarthest_px);
      is_near = is_near && pixel && (*pixel - observation.corners_px[i]).norm() < limit_px;
    }
    const bool is_sure = observation.corrected_bits == 0 && !observation.is_repeated;
    if (is_near) agreeing.insert(observation.tag);
    if (!is_near && is_sure) contradicting.insert(observation.tag);
  }
  return {static_cast<int>(agreeing.size()), static_cast<int>(contradicting.size())};
}

void discredit_tags_read_as_others(const PhotometricWorld& world, const std::vector<Detection>& detections,
                                   const MotionState& state, std::vector<TagEvidence>& tags) {
  const Pose view = camera_from_map(state.pose, world.mode);
  for (TagEvidence& evidence : tags) {
    const PhotometricTag& tag = world.tags[static_cast<std::size_t>(evidence.tag_index)];
    const bool is_another = std::ranges::any_of(detections, [&](const Detection& detection) {
      return detection.tag != tag.tag.key && detection.hamming.value_or(0) == 0 &&
             is_on_tag(world.model, detection, view * tag.tag.T_map_tag, tag.half_size_m());
    });
    if (is_another) evidence.correlation = 0.0;
  }
}

}  // namespace apriltrack
