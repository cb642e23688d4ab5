#include "blur_corners.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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

/// In the tag's plane, in half tag sizes; nullopt where the ray does not meet it.
std::optional<Eigen::Vector2d> on_plane(const CameraModel& model, const Eigen::Vector2d& pixel,
                                        const Pose& T_camera_tag, double half_size_m) {
  const auto ray = model.unproject(pixel);
  if (!ray) return std::nullopt;
  const Pose T_tag_camera = T_camera_tag.inverse();
  const Eigen::Vector3d direction = T_tag_camera.rotation() * *ray;
  const Eigen::Vector3d& eye = T_tag_camera.translation();
  const double depth = -eye.z() / direction.z();
  if (!(depth > 0.0) || !std::isfinite(depth)) return std::nullopt;
  return (eye + depth * direction).head<2>() / half_size_m;
}

/// Whether the detection takes the tag's place: its middle lies on it, and it is half to twice as large.
bool takes_place_of(const CameraModel& model, const Detection& detection, const Pose& T_camera_tag,
                    double half_size_m) {
  std::array<Eigen::Vector2d, kNumCorners> corners;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < kNumCorners; ++i) {
    const auto point = on_plane(model, detection.corners_px[i], T_camera_tag, half_size_m);
    if (!point) return false;
    corners[i] = *point;
    middle += *point / double{kNumCorners};
  }
  const double longest =
      std::max((corners[2] - corners[0]).norm(), (corners[3] - corners[1]).norm()) / std::sqrt(8.0);
  return middle.cwiseAbs().maxCoeff() < 1.0 && longest > 0.5 && longest < 2.0;
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
  std::set<int> agreeing, contradicting;
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
    const int index = observation.tag_index;
    if (is_near) agreeing.insert(index);
    if (!is_near && is_sure) contradicting.insert(index);
  }
  return {{agreeing.begin(), agreeing.end()}, {contradicting.begin(), contradicting.end()}};
}

std::vector<TagEvidence> quorum(const std::vector<TagEvidence>& tags, const TagVotes& votes) {
  std::vector<TagEvidence> result;
  std::ranges::copy_if(tags, std::back_inserter(result), [&](const TagEvidence& tag) {
    return std::ranges::count(votes.agreeing, tag.tag_index) > 0;
  });
  return result.empty() ? tags : result;
}

void discredit_tags_read_as_others(const PhotometricWorld& world, const std::vector<Detection>& detections,
                                   const MotionState& state, const TagVotes& votes,
                                   std::vector<TagEvidence>& tags) {
  const Pose view = camera_from_map(state.pose, world.mode);
  const auto agrees = [&](int index) { return std::ranges::count(votes.agreeing, index) > 0; };
  const auto is_of_agreeing_tag = [&](const Detection& detection) {
    const auto index = world.index.find(detection.tag);
    return index && agrees(static_cast<int>(*index));
  };
  for (TagEvidence& evidence : tags) {
    if (agrees(evidence.tag_index)) continue;
    const PhotometricTag& tag = world.tag_at(evidence.tag_index);
    const bool is_another = std::ranges::any_of(detections, [&](const Detection& detection) {
      return detection.tag != tag.tag.key && detection.hamming.value_or(0) == 0 &&
             !is_of_agreeing_tag(detection) &&
             takes_place_of(world.model, detection, view * tag.tag.T_map_tag, tag.half_size_m());
    });
    if (is_another) evidence.correlation = 0.0;
  }
}

}  // namespace apriltrack
