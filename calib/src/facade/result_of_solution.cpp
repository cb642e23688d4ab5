#include "facade/result_of_solution.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "apriltrack/calib/map_evidence.h"
#include "apriltrack/calib/systematic_errors.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/tags/tag_map.h"
#include "assess/part_evidence.h"
#include "assess/tag_flags.h"
#include "messages/camera_messages.h"

namespace apriltrack {
namespace {

constexpr double kManyRejectedOfTag = 0.1;

/// Into observations.frames, each once.
std::vector<int> frames_of(const Observations& observations, const std::vector<std::size_t>& views) {
  std::vector<int> frames;
  for (const std::size_t v : views) frames.push_back(observations.views[v].frame);
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::vector<RigPose> rig_poses(const Observations& observations, const PartSolution& solution) {
  std::vector<RigPose> poses;
  for (const int frame : frames_of(observations, solution.part.views)) {
    const auto f = static_cast<std::size_t>(frame);
    poses.push_back({observations.frames[f], solution.state.T_map_rig[f]});
  }
  return poses;
}

/// What constraints made of the map, and what is to be said of them.
void take_constraints(const PartSolution& solution, CalibrationResult& result, Findings& findings) {
  result.gauge = to_string(result.held_tag) + " held at the origin";
  if (!solution.constrained) return;
  result.is_frame_measured = !solution.constrained->gauge.empty();
  if (result.is_frame_measured) result.gauge = solution.constrained->gauge;
  result.is_vertical_measured = solution.constrained->is_vertical_measured;
  result.constraint_audits = solution.constrained->audits;
  for (std::size_t i = 0; i < solution.constraints.size(); ++i) {
    if (result.constraint_audits[i].is_used) result.constraints.push_back(solution.constraints[i]);
  }
  report_constraints(solution.constrained->notes, findings);
}

/// How well the part was seen, and what it was seen in.
void take_statistics(const Observations& observations, const PartSolution& solution,
                     const CalibrationOptions& options, CalibrationResult& result) {
  result.residual_rms_px = solution.total_rms_px;
  result.frames_used = static_cast<int>(frames_of(observations, solution.part.views).size());
  result.observations_used = static_cast<int>(solution.part.views.size());
  result.observations_rejected = static_cast<int>(solution.views_offered - solution.part.views.size());
  result.evidence = part_evidence(observations, solution, options);
}

std::vector<CameraCorrection> corrections_of(const Observations& observations, const CameraRig& rig,
                                             const CameraRefinement& cameras) {
  std::vector<CameraCorrection> corrections;
  for (const EstimatedParameter& one : cameras.estimates) {
    const auto camera = static_cast<std::size_t>(one.parameter.camera);
    corrections.push_back({rig.cameras[camera].name, name_of(one.parameter, observations.cameras[camera]),
                           unit_of(one.parameter), one.value, one.sigma});
  }
  return corrections;
}

}  // namespace

TagMap to_map(const Observations& observations, const PartSolution& solution, const std::string& frame) {
  TagMap map;
  map.frame = frame;
  map.default_family = key_of(observations, solution.part.tags.front()).family;
  std::vector<int> views(observations.tags.size(), 0);
  for (const std::size_t v : solution.part.views)
    ++views[static_cast<std::size_t>(observations.views[v].tag)];
  for (std::size_t i = 0; i < solution.part.tags.size(); ++i) {
    const auto t = static_cast<std::size_t>(solution.part.tags[i]);
    MapTag tag;
    tag.key = observations.tags[t];
    tag.size_m = observations.sizes_m[t];
    tag.T_map_tag = solution.state.T_map_tag[t];
    std::optional<TagCovariance> covariance;
    if (!solution.covariances.empty()) covariance = solution.covariances[i];
    if (covariance) tag.covariance = covariance->by_noise + covariance->by_bias;
    std::optional<Matrix6d> constrained;
    if (solution.constrained && !solution.constrained->change.lost_root.isZero(0.0))
      constrained = solution.constrained->covariances[i];
    if (solution.constrained) tag.covariance = solution.constrained->covariances[i];
    tag.statistics = TagStatistics{views[t], solution.residual_rms_px[i], {}};
    const std::optional<Matrix6d> by_noise = covariance ? std::optional(covariance->by_noise) : std::nullopt;
    flag_weak(is_weak(tag, views[t], by_noise, constrained), *tag.statistics);
    if (1.0 - static_cast<double>(views[t]) / solution.views_offered_by_tag[t] > kManyRejectedOfTag)
      tag.statistics->flags.emplace_back("outliers");
    if (std::ranges::find(solution.findings, static_cast<int>(t), &TagFinding::tag) !=
        solution.findings.end())  // others with a fault are not in the map
      tag.statistics->flags.emplace_back("bent");
    map.tags.push_back(std::move(tag));
  }
  return map;
}

void take_cameras(const Observations& observations, const CameraRig& rig, const PartSolution& solution,
                  const CalibrationOptions& options, CalibrationResult& result, Findings& findings) {
  result.rig = rig;
  if (const auto& open = solution.cameras.open) {
    result.open_corrections = corrections_of(observations, rig, *open);
    result.open_covariance = open->covariance;
  }
  if (!solution.cameras.refined.is_accepted) return;
  result.corrections = corrections_of(observations, rig, solution.cameras.refined);
  const bool is_offset_alone = std::ranges::all_of(
      solution.cameras.refined.estimates,
      [](const EstimatedParameter& one) { return one.parameter.kind == CameraParameter::Kind::kEdgeOffset; });
  result.corrections_covariance = solution.cameras.refined.covariance;
  result.rig = with_corrections(rig, solution.state.cameras, parameters_of(solution.cameras.refined));
  std::ranges::move(unusual_edges(result.corrections, options), std::back_inserter(findings));
  if (is_offset_alone) return;
  findings.push_back(reported(solution.cameras.refined, result.corrections));
}

void take_map(const Observations& observations, const PartSolution& solution,
              const CalibrationOptions& options, CalibrationResult& result, Findings& findings) {
  result.held_tag = key_of(observations, solution.held_tag);
  result.map = to_map(observations, solution, options.map_frame);
  take_constraints(solution, result, findings);
  take_statistics(observations, solution, options, result);
  result.rig_poses = rig_poses(observations, solution);
  result.print_batches = solution.print_batches;
  result.print_aspect = solution.print_aspect;
  result.time_errors = solution.time_errors;
}

}  // namespace apriltrack
