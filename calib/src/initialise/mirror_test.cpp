#include "initialise/mirror_test.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>

#include "apriltrack/base/degrees.h"
#include "apriltrack/geometry/rotation.h"
#include "initialise/hinge.h"
#include "initialise/hinge_starts.h"
#include "initialise/tag_groups.h"
#include "solve/group_motion.h"

namespace apriltrack {
namespace {

// Of half the robust sum of squares. What turns must be likelier by more than rounding; what stays is sure
// only if it is likelier than the other pose by e^10.
constexpr double kBetter = 2.0;
constexpr double kDecisive = 10.0;
constexpr double kSamePose_rad = 3.0 * kRadPerDeg;

struct Alternatives {
  GroupMotion now;
  std::optional<GroupMotion> best_other;  ///< Another pose that the fit stays in.
};

/// What a hypothesis is worth is asked of few frames first. No view costs less than nothing: a fit to some
/// that costs more than all of them may leaves no hope, unless it is a worse minimum than the one that all
/// would have led to. That by few it falls back into the present pose is less sure, and saves time where a
/// turn that is missed is asked for again.
enum class Fallback { kIsEnough, kIsAskedOfAll };

bool are_apart(const GroupMotion& a, const GroupMotion& b) {
  return rotation_angle_rad(a.motion.rotation(), b.motion.rotation()) >= kSamePose_rad;
}

/// By few frames. most: that it may cost.
bool is_hopeless(const Observations& observations, const Hinge& hinge, const std::vector<int>& group,
                 const MapState& state, const GroupMotion& start, double most, Fallback fallback) {
  const GroupMotion by_few =
      fit_group_motion(observations, hinge.few_views, group, state, start, {.wanted_cost = most});
  return by_few.cost > most || (fallback == Fallback::kIsEnough && !are_apart(by_few, {}));
}

Alternatives alternatives(const PartTask& task, const ViewIndex& index, const std::vector<int>& group,
                          const MapState& state, Fallback fallback) {
  const Observations& observations = task.observations;
  const Hinge hinge = find_hinge(observations, index, group);
  std::vector<GroupMotion> starts = mirrored_starts(observations, state, hinge);
  Alternatives result;
  if (starts.empty()) return result;
  std::ranges::move(proposed_starts(observations, task.candidates, state, hinge), std::back_inserter(starts));
  if (2 * hinge.few_views.size() <= hinge.views.size()) {
    const double most = cost_of_group(observations, hinge.views, group, state) + kDecisive;
    std::erase_if(starts, [&](const GroupMotion& start) {
      return is_hopeless(observations, hinge, group, state, start, most, fallback);
    });
  }
  if (starts.empty()) return result;
  result.now = fit_group_motion(observations, hinge.views, group, state, {});
  EnoughOfMotion enough{result.now.cost + kDecisive, {result.now}};
  for (const GroupMotion& start : starts) {
    GroupMotion other = fit_group_motion(observations, hinge.views, group, state, start, enough);
    if (!are_apart(other, result.now)) continue;
    if (other.cost < enough.wanted_cost) enough.minima.push_back(other);  // else it may have been given up
    if (!result.best_other || other.cost < result.best_other->cost) result.best_other = std::move(other);
  }
  return result;
}

std::vector<Alternatives> all_alternatives(const PartTask& task, const ViewIndex& index,
                                           const std::vector<std::vector<int>>& groups, const MapState& state,
                                           Fallback fallback, const ParallelFor& parallel) {
  std::vector<Alternatives> poses(groups.size());
  parallel(groups.size(),
           [&](std::size_t i) { poses[i] = alternatives(task, index, groups[i], state, fallback); });
  return poses;
}

/// The group's tags, the frames at the hinge, and those that show the group alone.
void take_over(const Observations& observations, const Part& part, const std::vector<int>& group,
               const GroupMotion& other, MapState& state) {
  std::set<int> frames_of_others;
  for (const std::size_t v : part.views) {
    if (!std::ranges::binary_search(group, observations.views[v].tag))
      frames_of_others.insert(observations.views[v].frame);
  }
  std::set<int> moved;
  for (const std::size_t v : part.views) {
    const int frame = observations.views[v].frame;
    if (frames_of_others.contains(frame) || !moved.insert(frame).second) continue;
    Pose& pose = state.T_map_rig[static_cast<std::size_t>(frame)];
    pose = other.motion * pose;
  }
  for (const auto& [frame, pose] : other.T_map_rig) state.T_map_rig[static_cast<std::size_t>(frame)] = pose;
  for (const int tag : group) {
    Pose& pose = state.T_map_tag[static_cast<std::size_t>(tag)];
    pose = other.motion * pose;
  }
}

}  // namespace

bool turn_mirrored_groups(const PartTask& task, const Part& part, int held_tag, MapState& state,
                          const ParallelFor& parallel) {
  const std::vector<std::vector<int>> groups = hinged_groups(task.observations, part);
  const ViewIndex index(task.observations, part);
  std::vector<Alternatives> poses =
      all_alternatives(task, index, groups, state, Fallback::kIsEnough, parallel);
  bool has_turned = false;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (has_turned)
      poses[i] = alternatives(task, index, groups[i], state,
                              Fallback::kIsEnough);  // they were of another map
    const auto& [now, best_other] = poses[i];
    if (!best_other || !(best_other->cost < now.cost - kBetter)) continue;
    take_over(task.observations, part, groups[i], *best_other, state);
    has_turned = true;
  }
  if (has_turned) move_origin_to(state, held_tag);
  return has_turned;
}

std::vector<std::vector<int>> undecided_groups(const PartTask& task, const Part& part, const MapState& state,
                                               const ParallelFor& parallel) {
  const std::vector<std::vector<int>> groups = hinged_groups(task.observations, part);
  const ViewIndex index(task.observations, part);
  const std::vector<Alternatives> poses =
      all_alternatives(task, index, groups, state, Fallback::kIsAskedOfAll, parallel);
  std::vector<std::vector<int>> undecided;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (poses[i].best_other && poses[i].best_other->cost < poses[i].now.cost + kDecisive)
      undecided.push_back(groups[i]);
  }
  return undecided;
}

}  // namespace apriltrack
