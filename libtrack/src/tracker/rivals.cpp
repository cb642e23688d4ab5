#include "rivals.h"

#include <algorithm>
#include <iterator>

#include "blur_covariance.h"
#include "place_spread.h"

namespace apriltrack {
namespace {

// Two explanations that look alike differ by what the model leaves out (how the motion changes within the
// exposure, the lens), which errs alike in all pixels: their difference counts a quarter. At a turn of
// room_blur the right one of path and reverse scored 10 less; the other explained nothing of the next frame,
// which may tell by hundreds of nats.
constexpr double kLeastScoreCarried = -40.0;
constexpr double kTrustInScores = 0.25;
constexpr double kDistinctSigmas = 5.0;
/// A rival: of a score as good but for so much, it puts a tag elsewhere by more than a path's reverse does.
constexpr double kLeastScoreOfRival = -7.0;
constexpr double kElsewhere_px = 10.0;

double score_over(const Explanation& best, const Explanation& other) {
  return std::min(0.0, other.score - best.score);
}

/// By score: what lies beyond its prior comes last in `found`, and may be right all the same. Null for none.
template <class Predicate>
const Explanation* best_where(const std::vector<Explanation>& found, const Predicate& is_one) {
  const Explanation* best = nullptr;
  for (const Explanation& one : found) {
    if (is_one(one) && (best == nullptr || one.score > best->score)) best = &one;
  }
  return best;
}

}  // namespace

bool is_another(const MotionBelief& belief, const Pose& pose) {
  return distance(belief, pose) > kDistinctSigmas;
}

MotionBelief belief_of(const PhotometricWorld& world, const Explanation& explanation) {
  MotionBelief belief{explanation.fit.state, fit_covariance(world, explanation.fit)};
  belief.covariance.topLeftCorner<6, 6>() += explanation.bend_covariance;
  belief.mean.acceleration.setZero();
  return belief;
}

bool has_rival(const PhotometricWorld& world, const std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  return std::any_of(std::next(found.begin()), found.end(), [&](const Explanation& other) {
    return other.score - best.score > kLeastScoreOfRival &&
           std::ranges::any_of(best.fit.tags, [&](const TagEvidence& tag) {
             return !(place_shift_px(world, world.tag_at(tag.tag_index), best.fit.state.pose,
                                     other.fit.state.pose) <= kElsewhere_px);
           });
  });
}

std::optional<SecondPose> second_pose(const MotionBelief& belief, const std::vector<Explanation>& found) {
  const Explanation* second =
      best_where(found, [&](const Explanation& other) { return is_another(belief, other.fit.state.pose); });
  if (second == nullptr) return std::nullopt;
  return SecondPose{second->fit.state.pose, kTrustInScores * score_over(found.front(), *second)};
}

std::vector<MotionHypothesis> motions_left_open(const PhotometricWorld& world, const MotionBelief& belief,
                                                const std::vector<Explanation>& found) {
  std::vector<MotionHypothesis> motions = {{belief, 0.0}};
  const Explanation* other = best_where(
      found, [&](const Explanation& one) { return distance(belief, one.fit.state) > kDistinctSigmas; });
  if (other == nullptr) return motions;
  const double less = score_over(found.front(), *other);
  if (less >= kLeastScoreCarried) motions.push_back({belief_of(world, *other), kTrustInScores * less});
  return motions;
}

}  // namespace apriltrack
