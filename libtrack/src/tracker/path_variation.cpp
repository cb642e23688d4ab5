#include "path_variation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <span>

#include "largest_tags.h"
#include "place_spread.h"

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
/// Of the path: a start that leads to about the same one again says that there is no other near.
constexpr double kLeastChange = 0.1;

bool is_path_long(const Explanation& explanation) {
  return longest_path_px(explanation) > (is_where_seen(explanation) ? kLongPathWhereSeen_px : kLongPath_px);
}

/// What a start found already, for others to be compared with.
MotionStart as_found(const Explanation& explanation) {
  return {explanation.fit.state, explanation.prior, explanation.is_cold};
}

/// Of the paths of the explained tags' centres during the exposure: how far their ends are apart, at most.
double ends_apart_px(const PhotometricWorld& world, const Explanation& best, const MotionState& a,
                     const MotionState& b, double exposure_s) {
  double apart_px = 0.0;
  for (const TagEvidence& tag : explained_tags(best.fit.tags)) {
    for (const double time_s : {-0.5 * exposure_s, 0.5 * exposure_s})
      apart_px = std::max(apart_px, place_shift_px(world, world.tag_at(tag.tag_index), pose_after(a, time_s),
                                                   pose_after(b, time_s)));
  }
  return apart_px;
}

/// Round by round from the best so far to the best of `others` of it, while that is better; in coarse pixels
/// alone. nullopt where none is.
std::optional<MotionStart> better_start(
    const StartFit& start_fit, const BlurFrame& frame, const Explanation& best, int max_rounds,
    const std::function<std::vector<MotionStart>(const MotionStart&)>& others) {
  const LargestTags some_tags(start_fit.world(), {&best.fit.state, 1});
  const Sketch as_it_is = start_fit.sketched(frame, as_found(best), 1);
  Sketch reached = as_it_is;
  for (int round = 0; round < max_rounds; ++round) {
    std::vector<Sketch> sketches;
    for (const MotionStart& start : others(reached.start))
      sketches.push_back(start_fit.sketched(frame, start, 2));
    const Sketch& first = *std::ranges::max_element(sketches, {}, &Sketch::score);
    if (!(first.score > reached.score)) break;
    const MotionState before = reached.start.state;
    reached = first;
    const double apart_px =
        ends_apart_px(start_fit.world(), best, before, reached.start.state, frame.photometric.exposure_s);
    if (apart_px < kLeastChange * longest_path_px(best)) break;
  }
  if (!(reached.score > as_it_is.score)) return std::nullopt;
  return reached.start;
}

void add_fit(const StartFit& start_fit, const BlurFrame& frame, const std::optional<MotionStart>& start,
             std::vector<Explanation>& found) {
  if (!start) return;
  found.push_back(start_fit.explained(frame, *start, {.coarsest_level = start->is_cold ? 1 : 0}));
  sort_by_score(found);
}

std::vector<MotionStart> varied_paths(const BlurFrame& frame, const MotionStart& best,
                                      std::span<const PathVariation> variations) {
  std::vector<MotionStart> starts;
  for (const PathVariation& variation : variations) {
    MotionStart start = best;
    start.state.pose = pose_after(best.state, variation.shift * frame.photometric.exposure_s);
    start.state.velocity *= variation.factor;
    starts.push_back(start);
  }
  return starts;
}

/// A detection alone does not say how the camera moves, and a fit that begins at rest stays there: a path and
/// its reverse look the same, so that no direction is better than rest at first. Turns of the camera each
/// way, by so many pixels during the exposure.
std::vector<MotionStart> turning_starts(const StartFit& start_fit, const BlurFrame& frame,
                                        const MotionStart& best) {
  constexpr int kNumWays = 6;  // of half a circle: the others are their reverses
  constexpr double kPaths_px[] = {8.0, 20.0};
  const PhotometricWorld& world = start_fit.world();
  const Matrix6d state_by_view = view_by_pose(best.state.pose, world.mode).inverse();
  std::vector<MotionStart> starts;
  for (const double path_px : kPaths_px) {
    const double rate_rad_per_s = path_px / (world.focal_px() * frame.photometric.exposure_s);
    for (int way = 0; way < kNumWays; ++way) {
      const double angle_rad = std::numbers::pi * way / kNumWays;
      Vector6d view_rate = Vector6d::Zero();
      view_rate.segment<2>(3) << rate_rad_per_s * std::cos(angle_rad), rate_rad_per_s * std::sin(angle_rad);
      MotionStart start = best;
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
  const auto others = [&](const MotionStart& start) {
    return is_way_unknown ? turning_starts(start_fit, frame, start)
                          : varied_paths(frame, start, kOtherVelocities);
  };
  add_fit(start_fit, frame, better_start(start_fit, frame, best, 1, others), found);
}

void vary_length(const StartFit& start_fit, const BlurFrame& frame, std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  if (!is_path_long(best)) return;
  const auto others = [&](const MotionStart& start) { return varied_paths(frame, start, kOtherLengths); };
  add_fit(start_fit, frame, better_start(start_fit, frame, best, kMaxLengthRounds, others), found);
}

}  // namespace apriltrack
