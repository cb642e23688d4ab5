#include "faults/tag_probe.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "model/corner_views.h"
#include "numerics/spread_selection.h"
#include "solve/camera_parameters.h"
#include "uncertainty/viewpoint_shares.h"

namespace apriltrack {
namespace {

constexpr double kDoubtfulSecondPose = 0.051;  // of a second pose; the least that equation (1) gives is 0.05
constexpr int kMaxFrameSteps = 4;

/// The poses and information of frames that show `tag`, by their other kept views.
struct FrameByOthers {
  std::vector<std::size_t> views;
  Pose T_map_rig;
  Matrix6d information = Matrix6d::Zero();
  bool is_sure = false;  ///< By two other tags or more that agree.
};

/// Each once, sorted: views are in the order of their frames.
std::vector<int> frames_of_views(const Observations& observations, const std::vector<std::size_t>& views) {
  std::vector<int> frames;
  for (const std::size_t v : views) {
    if (frames.empty() || frames.back() != observations.views[v].frame)
      frames.push_back(observations.views[v].frame);
  }
  return frames;
}

/// One tag that several cameras see is no witness beside itself.
bool has_two_tags(const Observations& observations, const std::vector<std::size_t>& views) {
  return std::ranges::any_of(views, [&](std::size_t v) {
    return observations.views[v].tag != observations.views[views.front()].tag;
  });
}

/// Where a frame is by its largest view, if that leaves one pose only.
std::optional<Pose> pose_by_one(const PartTask& task, const AdjustedPart& solved,
                                const std::vector<std::size_t>& views) {
  const std::size_t largest = *std::ranges::max_element(
      views, {}, [&](std::size_t v) { return mean_edge_px(task.observations.views[v].corners_px); });
  const auto& candidates = task.candidates[largest].candidates;
  if (candidates.empty() || (candidates.size() > 1 && candidates[1].weight > kDoubtfulSecondPose))
    return std::nullopt;
  const TagView& view = task.observations.views[largest];
  return solved.state.T_map_tag[static_cast<std::size_t>(view.tag)] * candidates.front().T_rig_tag.inverse();
}

/// Those of one tag; of very many some, spread evenly.
std::vector<std::size_t> views_to_probe(const Observations& observations, const Part& part, int tag) {
  std::vector<std::size_t> views = part.views;
  std::erase_if(views, [&](std::size_t v) { return observations.views[v].tag != tag; });
  return spread_selection(views, kMostProbes);
}

/// Frames of the part rest on what was kept there; others, which show one tag of it only, on that one.
std::map<int, std::vector<std::size_t>> views_of_others(const PartTask& task, const Part& part,
                                                        const AdjustedPart& solved, int tag,
                                                        const std::vector<std::size_t>& probed) {
  const std::vector<int> frames = frames_of_views(task.observations, probed);
  const std::vector<int> solved_frames = frames_of_views(task.observations, solved.part.views);
  std::map<int, std::vector<std::size_t>> others;
  for (const int frame : frames) {
    const bool is_solved = std::ranges::binary_search(solved_frames, frame);
    for (const std::size_t v : views_of_frame(task.observations, is_solved ? solved.part : part, frame)) {
      const int other = task.observations.views[v].tag;
      if (other != tag && std::ranges::binary_search(solved.part.tags, other)) others[frame].push_back(v);
    }
  }
  return others;
}

std::map<int, FrameByOthers> frames_by_others(const PartTask& task, const Part& part,
                                              const AdjustedPart& solved, int tag,
                                              const std::vector<std::size_t>& probed) {
  const std::vector<int> solved_frames = frames_of_views(task.observations, solved.part.views);
  std::map<int, FrameByOthers> result;
  MapState state = solved.state;
  for (const auto& [frame, views] : views_of_others(task, part, solved, tag, probed)) {
    Pose& pose = state.T_map_rig[static_cast<std::size_t>(frame)];
    // A frame that shows one other tag may have been mirrored with it to please the tag in question.
    const bool is_sure =
        has_two_tags(task.observations, views) && std::ranges::binary_search(solved_frames, frame);
    if (!is_sure) {
      const auto alone = pose_by_one(task, solved, views);
      if (!alone) continue;
      pose = *alone;
    }
    FrameByOthers& of_frame = result[frame];
    of_frame.views = views;
    of_frame.is_sure = is_sure;
    for (int step = 0; step < kMaxFrameSteps; ++step) {
      of_frame.information.setZero();
      Vector6d gradient = Vector6d::Zero();
      for (const LinearView& view : corner_views(task.observations, views, state)) {
        of_frame.information += view.by_rig.transpose().lazyProduct(view.by_rig);
        gradient += view.by_rig.transpose() * view.residual;
      }
      const Vector6d change = -of_frame.information.ldlt().solve(gradient);
      if (!change.allFinite()) break;
      pose = pose * Pose::exp(change);
    }
    of_frame.T_map_rig = pose;
  }
  return result;
}

/// Where views may be by the lenses that the map was solved with; empty where these are the task's, whose
/// candidates serve.
std::vector<ViewCandidates> candidates_by_other_lens(const PartTask& task, const AdjustedPart& solved,
                                                     const std::vector<std::size_t>& views) {
  if (!have_other_lenses(solved.state.cameras, task.observations.cameras)) return {};
  Observations by_cameras = task.observations;
  by_cameras.cameras = solved.state.cameras;
  return solve_views(by_cameras, views, parallel_for(1));
}

/// By where each view itself has the tag.
void share_viewpoints(std::vector<ProbeView>& probes) {
  std::vector<Eigen::Vector3d> lines_of_sight;
  for (const ProbeView& probe : probes) {
    const Pose T_map_camera = probe.T_map_rig * probe.camera->T_camera_rig.inverse();
    lines_of_sight.push_back(probe.T_map_tag_proposed.front().translation() - T_map_camera.translation());
  }
  const std::vector<double> shares = viewpoint_shares(lines_of_sight);
  for (std::size_t i = 0; i < probes.size(); ++i)
    if (probes[i].view->claimed_px2 > 0.0) probes[i].share = shares[i];
}

}  // namespace

std::vector<ProbeView> probe_views(const PartTask& task, const Part& part, const AdjustedPart& solved,
                                   int tag) {
  const std::vector<std::size_t> probed = views_to_probe(task.observations, part, tag);
  const auto others = frames_by_others(task, part, solved, tag, probed);
  MapState even = solved.state;  // what is wrong with the tag makes its views seem noisy
  even.noise.of_view.clear();
  const std::vector<ViewCandidates> own_candidates = candidates_by_other_lens(task, solved, probed);
  std::vector<ProbeView> probes;
  for (const std::size_t v : probed) {
    const TagView& view = task.observations.views[v];
    const auto frame = others.find(view.frame);
    if (frame == others.end()) continue;
    ProbeView probe{&view,
                    &solved.state.cameras[static_cast<std::size_t>(view.camera)],
                    frame->second.is_sure,
                    frame->second.T_map_rig,
                    task.observations.frames[static_cast<std::size_t>(view.frame)],
                    Matrix8d::Identity(),
                    1.0,
                    frame->second.views,
                    {}};
    const auto& candidates = (own_candidates.empty() ? task.candidates : own_candidates)[v].candidates;
    Vector8d residual_px;
    Matrix8x6d by_rig;
    if (candidates.empty() ||
        !view_residual(*probe.camera, task.observations.sizes_m[static_cast<std::size_t>(tag)], view,
                       probe.T_map_rig, probe.T_map_rig * candidates.front().T_rig_tag, &residual_px, &by_rig,
                       nullptr))
      continue;
    const Matrix8d W = whitening(view, even);
    const Matrix8x6d by_frame = W * by_rig;
    const Matrix8d covariance =
        Matrix8d::Identity() + by_frame * frame->second.information.ldlt().solve(by_frame.transpose());
    probe.whitening = covariance.llt().matrixL().solve(W);
    for (const auto& candidate : candidates)
      probe.T_map_tag_proposed.push_back(probe.T_map_rig * candidate.T_rig_tag);
    if (probe.whitening.allFinite()) probes.push_back(std::move(probe));
  }
  share_viewpoints(probes);
  return probes;
}

}  // namespace apriltrack
