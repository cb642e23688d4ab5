#include "path_variation.h"

#include <algorithm>
#include <span>

namespace apriltrack {
namespace {

/// Another path beside one that was found.
struct PathVariation {
  double factor;       ///< Of the velocity.
  double shift = 0.0;  ///< Of the middle, forward, in exposures.
};
/// Of the velocity found: at rest, and the path's reverse.
constexpr PathVariation kOtherVelocities[] = {{0.0}, {-1.0}};
/// A path that lies within a longer one, midway or at an end, explains its own pixels nearly as well.
constexpr PathVariation kOtherLengths[] = {{0.7}, {1.4}, {1.4, 0.2}, {1.4, -0.2}};

constexpr double kLongPath_px = 25.0;
/// Where the turn seen says about how long it is.
constexpr double kLongPathWhereSeen_px = 60.0;
constexpr int kMaxLengthRounds = 3;

bool is_path_long(const Explanation& explanation) {
  return longest_path_px(explanation) > (is_where_seen(explanation) ? kLongPathWhereSeen_px : kLongPath_px);
}

void vary_path(const StartFit& start_fit, const BlurFrame& frame, std::span<const PathVariation> variations,
               std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  const MotionStart as_found{best.fit.state, best.prior, best.is_cold};
  std::vector<Sketch> sketches;
  for (const PathVariation& variation : variations) {
    MotionStart start = as_found;
    start.state.pose = pose_after(best.fit.state, variation.shift * frame.photometric.exposure_s);
    start.state.velocity *= variation.factor;
    sketches.push_back(start_fit.sketched(frame, start, 2));
  }
  const Sketch& better = *std::ranges::max_element(sketches, {}, &Sketch::score);
  if (better.score < start_fit.sketched(frame, as_found, 1).score) return;
  found.push_back(start_fit.explained(frame, better.start, {.coarsest_level = 0}));
  sort_by_score(found);
}

}  // namespace

void vary_velocity(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found) {
  vary_path(start_fit, frame, kOtherVelocities, found);
}

void vary_length(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found) {
  for (int round = 0; round < kMaxLengthRounds && is_path_long(found.front()); ++round) {
    const double score = found.front().score;
    vary_path(start_fit, frame, kOtherLengths, found);
    if (found.front().score <= score) return;
  }
}

}  // namespace apriltrack
