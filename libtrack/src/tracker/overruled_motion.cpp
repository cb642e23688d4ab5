#include "overruled_motion.h"

#include <algorithm>
#include <optional>

#include "motion_start.h"

namespace apriltrack {
namespace {

/// Of scores, beyond what the prior takes off them. In 13 recordings, 3300 frames, no right explanation fell
/// short of one beyond its prior at all.
constexpr double kDecisiveScore = 20.0;

const Explanation& best_of_pixels(const std::vector<Explanation>& found) {
  return *std::ranges::max_element(found, {}, &Explanation::score);
}

/// Nothing but what the detections say that agree with the explanation.
std::optional<MotionStart> start_of_detections(const PhotometricWorld& world, const BlurFrame& frame,
                                               const Explanation& explanation) {
  PoseCandidate candidate;
  candidate.T_camera_map = camera_from_map(explanation.fit.state.pose, world.mode);
  for (const TagObservation& seen : frame.observations) {
    const bool is_sure = seen.corrected_bits == 0 && !seen.is_repeated;
    if (is_sure && std::ranges::count(explanation.votes.agreeing, seen.tag_index) > 0)
      candidate.inliers.push_back(&seen);
  }
  if (candidate.inliers.empty()) return std::nullopt;
  const auto belief = cold_belief(world, candidate);
  if (!belief) return std::nullopt;
  // As that of any detection which the motion so far did not expect.
  return MotionStart{explanation.fit.state, {*belief, -kMaxScoredPriorCost}, true};
}

}  // namespace

bool is_overruled(const std::vector<Explanation>& found) {
  const Explanation& other = best_of_pixels(found);
  return other.is_beyond_prior() && other.score > found.front().score + kDecisiveScore;
}

void start_over_where_overruled(const StartFit& start_fit, const BlurFrame& frame,
                                std::vector<Explanation>& found) {
  const Explanation& other = best_of_pixels(found);
  if (!is_overruled(found) || other.votes.agreeing.empty() || !other.votes.contradicting.empty()) return;
  if (const auto start = start_of_detections(start_fit.world(), frame, other)) {
    found.push_back(start_fit.explained(frame, *start, {.coarsest_level = 0}));
    sort_by_score(found);
  }
}

}  // namespace apriltrack
