#include "mirror_test.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "apriltrack/base/degrees.h"
#include "group_motion.h"
#include "tag_groups.h"
#include "tag_links.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMaxFrames = 40, kLeastFrames = 6;
constexpr std::size_t kMaxViews = 160;
constexpr std::size_t kFewFrames = 8;   // which may show already that a pose is no match
constexpr std::size_t kMaxAnchors = 2;  // on either side of a hinge
// Of half the robust sum of squares. What turns must be likelier by more than rounding; what stays is sure
// only if it is likelier than the other pose by e^10.
constexpr double kBetter = 2.0;
constexpr double kDecisive = 10.0;
constexpr double kSamePose_rad = 3.0 * kRadPerDeg;
// A mirrored tag is reflected about ONE line of sight: seen from 35 degrees off it, it is wrong by up to 70
// degrees, tens of pixels, which no fit explains. Skipping such tags only saves time.
constexpr double kDecidedSpread_rad = 35.0 * kRadPerDeg;

/// Where a group of tags meets the others: the frames that show both, and their views.
struct Hinge {
  std::vector<std::size_t> views;
  std::vector<std::size_t> few_views;       ///< Of few of the frames.
  std::vector<int> anchors, other_anchors;  ///< Tags of the group, and others, seen most often there.
};

std::vector<int> most_seen(const std::map<int, int>& counts) {
  std::vector<int> tags;
  for (const auto& [tag, count] : counts) tags.push_back(tag);
  std::stable_sort(tags.begin(), tags.end(), [&](int a, int b) { return counts.at(a) > counts.at(b); });
  tags.resize(std::min(tags.size(), kMaxAnchors));
  return tags;
}

/// The part's views by tag and by frame, so that a group costs no more than what is seen of it.
class ViewIndex {
 public:
  ViewIndex(const Observations& observations, const Part& part) : observations_(&observations), part_(&part) {
    int last_frame = -1;
    for (const std::size_t v : part.views) {
      const TagView& view = observations.views[v];
      of_tag_[view.tag].push_back(v);
      num_frames_ += view.frame != last_frame ? 1 : 0;
      last_frame = view.frame;
    }
  }

  std::size_t views_per_frame() const { return part_->views.size() / std::max<std::size_t>(1, num_frames_); }
  std::span<const std::size_t> of_frame(std::size_t frame) const {
    const auto range = std::ranges::equal_range(part_->views, static_cast<int>(frame), {},
                                                [&](std::size_t v) { return observations_->views[v].frame; });
    return {range.begin(), range.end()};
  }
  /// Those that show a tag of the group, and another one; sorted.
  std::vector<std::size_t> joint_frames(const std::vector<int>& group) const {
    std::set<std::size_t> frames;
    for (const int tag : group) {
      const auto views = of_tag_.find(tag);
      if (views == of_tag_.end()) continue;
      for (const std::size_t v : views->second)
        frames.insert(static_cast<std::size_t>(observations_->views[v].frame));
    }
    std::erase_if(frames, [&](std::size_t frame) {
      return std::ranges::all_of(of_frame(frame), [&](std::size_t v) { return is_of(group, v); });
    });
    return {frames.begin(), frames.end()};
  }
  bool is_of(const std::vector<int>& group, std::size_t v) const {
    return std::ranges::binary_search(group, observations_->views[v].tag);
  }

 private:
  const Observations* observations_;
  const Part* part_;
  std::map<int, std::vector<std::size_t>> of_tag_;
  std::size_t num_frames_ = 0;
};

Hinge find_hinge(const Observations& observations, const ViewIndex& index, const std::vector<int>& group) {
  const std::size_t num_frames =
      std::clamp(kMaxViews / std::max<std::size_t>(1, index.views_per_frame()), kLeastFrames, kMaxFrames);
  Hinge hinge;
  std::map<int, int> counts, other_counts;
  const std::vector<std::size_t> frames = spread_selection(index.joint_frames(group), num_frames);
  for (const std::size_t frame : frames) {
    for (const std::size_t v : index.of_frame(frame)) {
      hinge.views.push_back(v);
      ++(index.is_of(group, v) ? counts : other_counts)[observations.views[v].tag];
    }
  }
  for (const std::size_t frame : spread_selection(frames, kFewFrames)) {
    const auto views = index.of_frame(frame);
    hinge.few_views.insert(hinge.few_views.end(), views.begin(), views.end());
  }
  hinge.anchors = most_seen(counts);
  hinge.other_anchors = most_seen(other_counts);
  return hinge;
}

/// The mean direction from the tag to the cameras that see it in these views, in the tag's frame; none where
/// two of them or more are so far apart that they leave one pose only.
std::optional<Eigen::Vector3d> direction_of_doubt(const Observations& observations, const MapState& state,
                                                  const std::vector<std::size_t>& views, int tag) {
  std::vector<Eigen::Vector3d> directions;
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    if (view.tag != tag) continue;
    const Pose T_tag_camera = state.T_map_tag[static_cast<std::size_t>(tag)].inverse() *
                              state.T_map_rig[static_cast<std::size_t>(view.frame)] *
                              state.cameras[static_cast<std::size_t>(view.camera)].T_camera_rig.inverse();
    directions.push_back(T_tag_camera.translation().normalized());
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& direction : directions) mean += direction;
  mean.normalize();
  const auto far = std::count_if(directions.begin(), directions.end(), [&](const Eigen::Vector3d& direction) {
    return direction.dot(mean) < std::cos(kDecidedSpread_rad);
  });
  return far >= 2 || !mean.allFinite() ? std::nullopt : std::optional(mean);
}

/// What takes the tag to its mirrored pose.
std::optional<Pose> mirroring(const Observations& observations, const MapState& state,
                              const std::vector<std::size_t>& views, int tag) {
  const auto direction = direction_of_doubt(observations, state, views, tag);
  if (!direction) return std::nullopt;
  const Pose& pose = state.T_map_tag[static_cast<std::size_t>(tag)];
  return mirrored_about(pose, pose.rotation() * *direction) * pose.inverse();
}

/// Where the group would lie if a tag at the hinge were seen mirrored: its own one, the frames as they are;
/// or one of the others, and the frames are where the group has them.
std::vector<GroupMotion> hypotheses(const Observations& observations, const MapState& state,
                                    const Hinge& hinge) {
  std::vector<GroupMotion> result;
  for (const int tag : hinge.anchors) {
    if (const auto motion = mirroring(observations, state, hinge.views, tag))
      result.push_back({*motion, {}, 0.0});
  }
  for (const int tag : hinge.other_anchors) {
    const auto mirror = mirroring(observations, state, hinge.views, tag);
    if (!mirror) continue;
    GroupMotion start{mirror->inverse(), {}, 0.0};
    for (const std::size_t v : hinge.views) {
      const int frame = observations.views[v].frame;
      start.T_map_rig[frame] = start.motion * state.T_map_rig[static_cast<std::size_t>(frame)];
    }
    result.push_back(std::move(start));
  }
  return result;
}

struct Alternatives {
  GroupMotion now;
  std::optional<GroupMotion> best_other;  ///< Another pose that the fit stays in.
};

/// What a hypothesis is worth is asked of few frames first. No view costs less than nothing: a fit to some
/// that costs more than all of them may leaves no hope, unless it is a worse minimum than the one that all
/// would have led to. That by few it falls back into the present pose is less sure, and saves time where a
/// turn that is missed is asked for again.
enum class Fallback { kIsEnough, kIsAskedOfAll };

Alternatives alternatives(const Observations& observations, const ViewIndex& index,
                          const std::vector<int>& group, const MapState& state, Fallback fallback) {
  const Hinge hinge = find_hinge(observations, index, group);
  const std::vector<GroupMotion> starts = hypotheses(observations, state, hinge);
  Alternatives result;
  if (starts.empty()) return result;
  result.now = fit_group_motion(observations, hinge.views, group, state, {});
  const double most = result.now.cost + kDecisive;
  const bool are_few = 2 * hinge.few_views.size() <= hinge.views.size();
  const auto is_another = [&](const GroupMotion& other) {
    return rotation_angle_rad(other.motion.rotation(), result.now.motion.rotation()) >= kSamePose_rad;
  };
  for (const GroupMotion& start : starts) {
    if (are_few) {
      const GroupMotion by_few = fit_group_motion(observations, hinge.few_views, group, state, start, most);
      if (by_few.cost > most || (fallback == Fallback::kIsEnough && !is_another(by_few))) continue;
    }
    GroupMotion other = fit_group_motion(observations, hinge.views, group, state, start, most);
    if (!is_another(other)) continue;
    if (!result.best_other || other.cost < result.best_other->cost) result.best_other = std::move(other);
  }
  return result;
}

std::vector<Alternatives> all_alternatives(const Observations& observations, const ViewIndex& index,
                                           const std::vector<std::vector<int>>& groups, const MapState& state,
                                           Fallback fallback, const ParallelFor& parallel) {
  std::vector<Alternatives> poses(groups.size());
  parallel(groups.size(),
           [&](std::size_t i) { poses[i] = alternatives(observations, index, groups[i], state, fallback); });
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

Pose mirrored_about(const Pose& T_frame_tag, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d d = direction.normalized();
  const Eigen::Matrix3d reflection = Eigen::Matrix3d::Identity() - 2.0 * d * d.transpose();
  const Eigen::Matrix3d R = T_frame_tag.rotation_matrix();
  Eigen::Matrix3d mirrored;
  mirrored.col(0) = reflection * R.col(0);
  mirrored.col(1) = reflection * R.col(1);
  mirrored.col(2) = mirrored.col(0).cross(mirrored.col(1));
  return {mirrored, T_frame_tag.translation()};
}

bool turn_mirrored_groups(const Observations& observations, const Part& part, int held_tag, MapState& state,
                          const ParallelFor& parallel) {
  const std::vector<std::vector<int>> groups = hinged_groups(observations, part);
  const ViewIndex index(observations, part);
  std::vector<Alternatives> poses =
      all_alternatives(observations, index, groups, state, Fallback::kIsEnough, parallel);
  bool has_turned = false;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (has_turned)
      poses[i] = alternatives(observations, index, groups[i], state,
                              Fallback::kIsEnough);  // they were of another map
    const auto& [now, best_other] = poses[i];
    if (!best_other || !(best_other->cost < now.cost - kBetter)) continue;
    take_over(observations, part, groups[i], *best_other, state);
    has_turned = true;
  }
  if (has_turned) move_origin_to(state, held_tag);
  return has_turned;
}

std::vector<std::vector<int>> undecided_groups(const Observations& observations, const Part& part,
                                               const MapState& state, const ParallelFor& parallel) {
  const std::vector<std::vector<int>> groups = hinged_groups(observations, part);
  const ViewIndex index(observations, part);
  const std::vector<Alternatives> poses =
      all_alternatives(observations, index, groups, state, Fallback::kIsAskedOfAll, parallel);
  std::vector<std::vector<int>> undecided;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (poses[i].best_other && poses[i].best_other->cost < poses[i].now.cost + kDecisive)
      undecided.push_back(groups[i]);
  }
  return undecided;
}

}  // namespace apriltrack
