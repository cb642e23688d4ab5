#include "model/map_state.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "apriltrack/base/check.h"
#include "apriltrack/base/parallel.h"
#include "model/tag_links.h"
#include "numerics/cauchy_loss.h"
#include "numerics/spread_selection.h"

namespace apriltrack {
namespace {

// Poses chained along the tree are a few pixels off before any adjustment, flips and misreads tens of pixels.
constexpr CauchyLoss kChainedErrorLoss{4.0};  // px
constexpr double kFailedProjection_px = 1000.0;
constexpr int kRounds = 2;
constexpr std::size_t kMaxProposers =
    8;                                  // tags (for a frame) or frames (for a tag) whose candidates are tried
constexpr std::size_t kMaxJudges = 24;  // views that judge a candidate

using Groups = std::map<int, std::vector<std::size_t>>;

Groups views_by_frame(const Observations& observations, const Part& part) {
  Groups groups;
  for (const std::size_t v : part.views) groups[observations.views[v].frame].push_back(v);
  return groups;
}

Groups views_by_tag(const Observations& observations, const Part& part) {
  Groups groups;
  for (const std::size_t v : part.views) groups[observations.views[v].tag].push_back(v);
  return groups;
}

Pose& tag_pose(MapState& state, const TagView& view) {
  return state.T_map_tag[static_cast<std::size_t>(view.tag)];
}
Pose& rig_pose(MapState& state, const TagView& view) {
  return state.T_map_rig[static_cast<std::size_t>(view.frame)];
}

/// Sum over the corners: grows for every error, but no view can outvote the others.
double robust_error(const Observations& observations, const TagView& view,
                    const std::vector<RigCamera>& cameras, const Pose& T_map_rig, const Pose& T_map_tag) {
  Vector8d residual;
  if (!view_residual(cameras[static_cast<std::size_t>(view.camera)],
                     observations.sizes_m[static_cast<std::size_t>(view.tag)], view, T_map_rig, T_map_tag,
                     &residual, nullptr, nullptr))
    return kNumCorners * kChainedErrorLoss.cost(kFailedProjection_px * kFailedProjection_px);
  double sum = 0.0;
  for (int i = 0; i < kNumCorners; ++i)
    sum += kChainedErrorLoss.cost(residual.segment<2>(2 * i).squaredNorm());
  return sum;
}

/// The largest views first: their candidates are the most exact.
std::vector<std::size_t> largest(const Observations& observations, std::vector<std::size_t> views,
                                 std::size_t limit) {
  std::stable_sort(views.begin(), views.end(), [&](std::size_t a, std::size_t b) {
    return mean_edge_px(observations.views[a].corners_px) > mean_edge_px(observations.views[b].corners_px);
  });
  if (views.size() > limit) views.resize(limit);
  return views;
}

void place_frame(const Observations& observations, const std::vector<std::size_t>& views,
                 const std::vector<ViewCandidates>& candidates, bool keep_current, MapState& state) {
  Pose& current = rig_pose(state, observations.views[views.front()]);
  const auto error_of = [&](const Pose& T_map_rig) {
    double sum = 0.0;
    for (const std::size_t v : views)
      sum += robust_error(observations, observations.views[v], state.cameras, T_map_rig,
                          tag_pose(state, observations.views[v]));
    return sum;
  };
  Pose best = current;
  double best_error = keep_current ? error_of(current) : HUGE_VAL;
  for (const std::size_t v : largest(observations, views, kMaxProposers)) {
    for (const auto& candidate : candidates[v].candidates) {
      const Pose T_map_rig = tag_pose(state, observations.views[v]) * candidate.T_rig_tag.inverse();
      const double error = error_of(T_map_rig);
      if (error < best_error) {
        best = T_map_rig;
        best_error = error;
      }
    }
  }
  current = best;
}

void place_tag(const Observations& observations, const std::vector<std::size_t>& views,
               const std::vector<ViewCandidates>& candidates, MapState& state) {
  Pose& current = tag_pose(state, observations.views[views.front()]);
  const std::vector<std::size_t> judges = spread_selection(views, kMaxJudges);
  const auto error_of = [&](const Pose& T_map_tag) {
    double sum = 0.0;
    for (const std::size_t v : judges)
      sum += robust_error(observations, observations.views[v], state.cameras,
                          rig_pose(state, observations.views[v]), T_map_tag);
    return sum;
  };
  Pose best = current;
  double best_error = error_of(current);
  for (const std::size_t v : largest(observations, views, kMaxProposers)) {
    for (const auto& candidate : candidates[v].candidates) {
      const Pose T_map_tag = rig_pose(state, observations.views[v]) * candidate.T_rig_tag;
      const double error = error_of(T_map_tag);
      if (error < best_error) {
        best = T_map_tag;
        best_error = error;
      }
    }
  }
  current = best;
}

}  // namespace

double scale_by_claim(const TagView& view, double beyond_px) {
  if (!(view.claimed_px2 > 0.0)) return 1.0;
  return std::sqrt((view.claimed_px2 + beyond_px * beyond_px) /
                   (view.claimed_px2 + kBeyondClaim_px * kBeyondClaim_px));
}

Vector8d noise_weights(const TagView& view, const MapState& state) {
  const NoiseScale& noise = state.noise;
  double scale = scale_by_claim(view, noise.beyond_px);
  if (!noise.of_frame.empty()) scale *= noise.of_frame[static_cast<std::size_t>(view.frame)];
  if (view.index < noise.of_view.size()) scale *= noise.of_view[view.index];
  Vector8d weights;
  for (int edge = 0; edge < 4; ++edge)
    weights.segment<2>(2 * edge) << 1.0 / (noise.sum * scale), 1.0 / (noise.difference * scale);
  return weights;
}

Matrix8d whitening(const TagView& view, const MapState& state) {
  return noise_weights(view, state).asDiagonal() * view.whitening;
}

bool residual_of(const Observations& observations, const TagView& view, const MapState& state,
                 Vector8d* residual_px, Matrix8x6d* by_rig, Matrix8x6d* by_tag) {
  return view_residual(state.cameras[static_cast<std::size_t>(view.camera)],
                       observations.sizes_m[static_cast<std::size_t>(view.tag)], view,
                       state.T_map_rig[static_cast<std::size_t>(view.frame)],
                       state.T_map_tag[static_cast<std::size_t>(view.tag)], residual_px, by_rig, by_tag);
}

void move_origin_to(MapState& state, int tag) {
  const Pose T_tag_map = state.T_map_tag[static_cast<std::size_t>(tag)].inverse();
  for (Pose& pose : state.T_map_tag) pose = T_tag_map * pose;
  for (Pose& pose : state.T_map_rig) pose = T_tag_map * pose;
  state.T_map_tag[static_cast<std::size_t>(tag)] = Pose::identity();
}

MapState start_state(const Observations& observations, const Part& part, int held_tag,
                     const std::vector<ViewCandidates>& candidates, const ParallelFor& parallel) {
  MapState state{std::vector<Pose>(observations.tags.size()),
                 std::vector<Pose>(observations.frames.size()),
                 observations.cameras,
                 {}};
  const auto tree = poses_along_tree(observations.tags.size(), held_tag,
                                     find_links(observations, part, candidates, parallel));
  for (const int tag : part.tags) {
    const auto& T_held_tag = tree[static_cast<std::size_t>(tag)];
    APRILTRACK_CHECK(T_held_tag.has_value(), "the links of a connected part reach every tag of it");
    state.T_map_tag[static_cast<std::size_t>(tag)] = *T_held_tag;
  }
  const Groups frames = views_by_frame(observations, part), tags = views_by_tag(observations, part);
  for (const auto& [frame, views] : frames) place_frame(observations, views, candidates, false, state);
  for (int round = 0; round < kRounds; ++round) {
    for (const auto& [tag, views] : tags) {
      if (tag != held_tag) place_tag(observations, views, candidates, state);
    }
    for (const auto& [frame, views] : frames) place_frame(observations, views, candidates, true, state);
  }
  return state;
}

Vector8d whitened_residual(const Observations& observations, const TagView& view, const MapState& state,
                           bool& is_valid, Vector8d* residual_px) {
  Vector8d residual = Vector8d::Zero();
  is_valid = residual_of(observations, view, state, &residual);
  if (residual_px != nullptr) *residual_px = residual;
  return whitening(view, state) * residual;
}

}  // namespace apriltrack
