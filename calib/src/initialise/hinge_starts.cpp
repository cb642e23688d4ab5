#include "initialise/hinge_starts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "apriltrack/base/degrees.h"
#include "apriltrack/geometry/rotation.h"
#include "numerics/cauchy_loss.h"
#include "numerics/spread_selection.h"

namespace apriltrack {
namespace {

// A mirrored tag is reflected about ONE line of sight: seen from 35 degrees off it, it is wrong by up to 70
// degrees, tens of pixels, which no fit explains. Skipping such tags only saves time.
constexpr double kDecidedSpread_rad = 35.0 * kRadPerDeg;
constexpr std::size_t kMostProposers = 6, kMostJudges = 12, kMostProposed = 6;
constexpr double kMostOfPresent = 2.0;  // of the cost by the present pose, judged alike
constexpr double kSameStart_rad = 6.0 * kRadPerDeg;
constexpr int kMeanShifts = 3;
constexpr CauchyLoss kProposalLoss{30.0};  // of a view's whitened norm: a single frame's poses are rough
constexpr double kUnseenAtHinge = 1e4;     // cost of a view that cannot be projected

const double kTurnedAlike = std::cos(0.5 * 20.0 * kRadPerDeg);  // of half the angle between

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

std::vector<Pose> mirrorings(const Observations& observations, const MapState& state,
                             const std::vector<std::size_t>& views, const std::vector<int>& tags) {
  std::vector<Pose> result;
  for (const int tag : tags) {
    if (const auto motion = mirroring(observations, state, views, tag)) result.push_back(*motion);
  }
  return result;
}

/// A frame that shows both anchors.
struct AnchorViews {
  std::size_t own = 0, other = 0;  ///< Views.
};

/// Of the two anchors that most frames show together.
std::vector<AnchorViews> anchor_views(const Observations& observations, const Hinge& hinge) {
  std::map<std::pair<int, int>, std::map<int, std::array<std::optional<std::size_t>, 2>>> by_anchors;
  for (const int own : hinge.anchors) {
    for (const int other : hinge.other_anchors) {
      auto& frames = by_anchors[{own, other}];
      for (const std::size_t v : hinge.views) {
        const TagView& view = observations.views[v];
        if (view.tag == own || view.tag == other) frames[view.frame][view.tag == own ? 0 : 1] = v;
      }
    }
  }
  std::vector<AnchorViews> best;
  for (const auto& [anchors, frames] : by_anchors) {
    std::vector<AnchorViews> joint;
    for (const auto& [frame, views] : frames)
      if (views[0] && views[1]) joint.push_back({*views[0], *views[1]});
    if (joint.size() > best.size()) best = std::move(joint);
  }
  return best;
}

bool is_same_start(const Pose& a, const Pose& b) {
  return rotation_angle_rad(a.rotation(), b.rotation()) < kSameStart_rad;
}

/// Poses of the group by single frames, judged by how well those that show both anchors agree.
class Proposals {
 public:
  Proposals(const Observations& observations, const std::vector<ViewCandidates>& candidates,
            const MapState& state, const Hinge& hinge)
      : observations_(observations),
        candidates_(candidates),
        state_(state),
        joint_(anchor_views(observations, hinge)),
        judges_(spread_selection(joint_, kMostJudges)) {}

  /// By single frames, and each of these drawn to the mean of what others propose that turn the group alike:
  /// the pose of a small tag in one frame is off by degrees, more than lies between two minima.
  std::vector<Pose> of_frames() const {
    std::vector<Pose> motions;
    for (const AnchorViews& joint : spread_selection(joint_, kMostProposers))
      std::ranges::move(of_frame(joint), std::back_inserter(motions));
    std::vector<std::vector<Pose>> by_frame;
    for (const AnchorViews& joint : judges_) {
      if (std::vector<Pose> proposed = of_frame(joint); !proposed.empty())
        by_frame.push_back(std::move(proposed));
    }
    const std::size_t num_single = motions.size();
    for (std::size_t i = 0; i < num_single; ++i) motions.push_back(drawn_to_means(by_frame, motions[i]));
    return motions;
  }

  /// The likeliest that differ from each other, and from where the group lies.
  std::vector<GroupMotion> best_of(const std::vector<Pose>& motions) const {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    const GroupMotion present{Pose::identity(), {}, judge(Pose::identity(), kAny)};
    std::vector<GroupMotion> all;
    for (const Pose& motion : motions) {
      if (is_same_start(motion, present.motion)) continue;
      const double most = kMostOfPresent * present.cost;
      if (const double cost = judge(motion, most); cost <= most) all.push_back({motion, {}, cost});
    }
    std::ranges::stable_sort(all, {}, &GroupMotion::cost);
    std::vector<GroupMotion> distinct{present};
    for (const GroupMotion& one : all) {
      const bool is_new = std::ranges::none_of(
          distinct, [&](const GroupMotion& other) { return is_same_start(one.motion, other.motion); });
      if (is_new && distinct.size() <= kMostProposed) distinct.push_back(one);
    }
    distinct.erase(distinct.begin());
    for (GroupMotion& one : distinct)
      for (const AnchorViews& joint : joint_)
        one.T_map_rig[observations_.views[joint.own].frame] = placed(joint, one.motion).second;
    return distinct;
  }

 private:
  const Pose& tag_pose(std::size_t v) const {
    return state_.T_map_tag[static_cast<std::size_t>(observations_.views[v].tag)];
  }

  std::vector<Pose> of_frame(const AnchorViews& joint) const {
    std::vector<Pose> motions;
    for (const auto& own : candidates_[joint.own].candidates)
      for (const auto& other : candidates_[joint.other].candidates)
        motions.push_back(tag_pose(joint.other) * other.T_rig_tag.inverse() * own.T_rig_tag *
                          tag_pose(joint.own).inverse());
    return motions;
  }

  /// A few steps of mean shift. by_frame: what each proposes; none is empty, and neither is it.
  Pose drawn_to_means(const std::vector<std::vector<Pose>>& by_frame, Pose motion) const {
    const Pose& T_map_own = tag_pose(joint_.front().own);  // turns about it leave the group where it is
    for (int i = 0; i < kMeanShifts; ++i) {
      const Pose T_map_moved = motion * T_map_own;
      Vector6d sum = Vector6d::Zero();
      double count = 0.0;
      for (const std::vector<Pose>& motions : by_frame) {
        const auto likeness = [&](const Pose& one) {  // cosine of half the angle between
          return std::abs(one.rotation().dot(motion.rotation()));
        };
        const Pose& nearest = *std::ranges::max_element(motions, {}, likeness);
        if (likeness(nearest) < kTurnedAlike) continue;
        sum += (T_map_moved.inverse() * nearest * T_map_own).log();
        count += 1.0;
      }
      if (count == 0.0) break;
      motion = T_map_moved * Pose::exp(sum / count) * T_map_own.inverse();
    }
    return motion;
  }

  /// The cost; where it is more than `most`, in part.
  double judge(const Pose& motion, double most) const {
    double sum = 0.0;
    for (const AnchorViews& joint : judges_) {
      sum += placed(joint, motion).first;
      if (sum > most) break;
    }
    return sum;
  }

  /// By the best of what the two tags propose.
  std::pair<double, Pose> placed(const AnchorViews& joint, const Pose& motion) const {
    std::pair<double, Pose> best{std::numeric_limits<double>::infinity(), Pose::identity()};
    const std::pair<std::size_t, Pose> places[] = {{joint.own, motion * tag_pose(joint.own)},
                                                   {joint.other, tag_pose(joint.other)}};
    for (const auto& [proposer, T_map_tag] : places) {
      for (const auto& candidate : candidates_[proposer].candidates) {
        const Pose T_map_rig = T_map_tag * candidate.T_rig_tag.inverse();
        double cost = 0.0;
        for (const auto& [v, pose] : places) cost += cost_of(v, T_map_rig, pose);
        if (cost < best.first) best = {cost, T_map_rig};
      }
    }
    return best;
  }

  double cost_of(std::size_t v, const Pose& T_map_rig, const Pose& T_map_tag) const {
    const TagView& view = observations_.views[v];
    Vector8d residual_px;
    if (!view_residual(state_.cameras[static_cast<std::size_t>(view.camera)],
                       observations_.sizes_m[static_cast<std::size_t>(view.tag)], view, T_map_rig, T_map_tag,
                       &residual_px, nullptr, nullptr))
      return kUnseenAtHinge;
    const Vector8d weights = noise_weights(view, state_);
    return kProposalLoss.cost(weights.cwiseProduct(view.whitening * residual_px).squaredNorm());
  }

  const Observations& observations_;
  const std::vector<ViewCandidates>& candidates_;
  const MapState& state_;
  std::vector<AnchorViews> joint_;
  std::vector<AnchorViews> judges_;  ///< Some of those.
};

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

std::vector<GroupMotion> mirrored_starts(const Observations& observations, const MapState& state,
                                         const Hinge& hinge) {
  std::vector<GroupMotion> result;
  for (const Pose& motion : mirrorings(observations, state, hinge.views, hinge.anchors))
    result.push_back({motion, {}, 0.0});
  for (const Pose& other : mirrorings(observations, state, hinge.views, hinge.other_anchors)) {
    GroupMotion start{other.inverse(), {}, 0.0};
    for (const std::size_t v : hinge.views) {
      const int frame = observations.views[v].frame;
      start.T_map_rig[frame] = start.motion * state.T_map_rig[static_cast<std::size_t>(frame)];
    }
    result.push_back(std::move(start));
  }
  return result;
}

std::vector<GroupMotion> proposed_starts(const Observations& observations,
                                         const std::vector<ViewCandidates>& candidates, const MapState& state,
                                         const Hinge& hinge) {
  const Proposals proposals(observations, candidates, state, hinge);
  std::vector<Pose> motions = proposals.of_frames();
  const std::vector<Pose> others = mirrorings(observations, state, hinge.views, hinge.other_anchors);
  for (const Pose& own : mirrorings(observations, state, hinge.views, hinge.anchors))
    for (const Pose& other : others) motions.push_back(other.inverse() * own);
  return proposals.best_of(motions);
}

}  // namespace apriltrack
