#include "path_variation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "largest_tags.h"

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

/// What a start found already, for others to be compared with.
MotionStart as_found(const Explanation& explanation) {
  return {explanation.fit.state, explanation.prior, explanation.is_cold};
}

/// The best of the starts is fitted where it is better than the best found, coarsely.
void try_starts(const StartFit& start_fit, const BlurFrame& frame, const std::vector<MotionStart>& starts,
                std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  const auto better = [&]() -> std::optional<Sketch> {
    const LargestTags some_tags(start_fit.world(), {&best.fit.state, 1});
    std::vector<Sketch> sketches;
    for (const MotionStart& start : starts) sketches.push_back(start_fit.sketched(frame, start, 2));
    const Sketch first = *std::ranges::max_element(sketches, {}, &Sketch::score);
    if (first.score < start_fit.sketched(frame, as_found(best), 1).score) return std::nullopt;
    return first;
  }();
  if (!better) return;
  found.push_back(
      start_fit.explained(frame, better->start, {.coarsest_level = better->start.is_cold ? 1 : 0}));
  sort_by_score(found);
}

std::vector<MotionStart> varied_paths(const BlurFrame& frame, const Explanation& best,
                                      std::span<const PathVariation> variations) {
  std::vector<MotionStart> starts;
  for (const PathVariation& variation : variations) {
    MotionStart start = as_found(best);
    start.state.pose = pose_after(best.fit.state, variation.shift * frame.photometric.exposure_s);
    start.state.velocity *= variation.factor;
    starts.push_back(start);
  }
  return starts;
}

/// A detection alone does not say how the camera moves, and a fit that begins at rest stays there: a path and
/// its reverse look the same, so that no direction is better than rest at first. Turns of the camera each
/// way, by so many pixels during the exposure.
std::vector<MotionStart> turning_starts(const StartFit& start_fit, const BlurFrame& frame,
                                        const Explanation& best) {
  constexpr int kNumWays = 6;  // of half a circle: the others are their reverses
  constexpr double kPaths_px[] = {8.0, 20.0};
  const PhotometricWorld& world = start_fit.world();
  const Matrix6d state_by_view = view_by_pose(best.fit.state.pose, world.mode).inverse();
  std::vector<MotionStart> starts;
  for (const double path_px : kPaths_px) {
    const double rate_rad_per_s = path_px / (world.focal_px() * frame.photometric.exposure_s);
    for (int way = 0; way < kNumWays; ++way) {
      const double angle_rad = std::numbers::pi * way / kNumWays;
      Vector6d view_rate = Vector6d::Zero();
      view_rate.segment<2>(3) << rate_rad_per_s * std::cos(angle_rad), rate_rad_per_s * std::sin(angle_rad);
      MotionStart start = as_found(best);
      start.state.velocity = state_by_view * view_rate;
      starts.push_back(start);
    }
  }
  return starts;
}

}  // namespace

void vary_velocity(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  const bool is_way_unknown = best.is_cold && frame.photometric.exposure_s > 0.0;
  try_starts(
      start_fit, frame,
      is_way_unknown ? turning_starts(start_fit, frame, best) : varied_paths(frame, best, kOtherVelocities),
      found);
}

void vary_length(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found) {
  for (int round = 0; round < kMaxLengthRounds && is_path_long(found.front()); ++round) {
    const double score = found.front().score;
    try_starts(start_fit, frame, varied_paths(frame, found.front(), kOtherLengths), found);
    if (found.front().score <= score) return;
  }
}

}  // namespace apriltrack
