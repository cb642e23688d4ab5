#include "assess/part_evidence.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <utility>

#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/map_evidence.h"

namespace apriltrack {
namespace {

/// Frames of the part by time; numbers of moments by frame.
std::vector<RigPose> moments_by_time(const Observations& observations, const PartSolution& solution,
                                     std::map<int, int>& moment_of_frame) {
  for (const std::size_t v : solution.part.views) moment_of_frame[observations.views[v].frame] = 0;
  std::vector<int> frames;
  for (const auto& [frame, moment] : moment_of_frame) frames.push_back(frame);
  std::ranges::stable_sort(frames, {},
                           [&](int frame) { return observations.frames[static_cast<std::size_t>(frame)]; });
  std::vector<RigPose> moments;
  for (const int frame : frames) {
    const auto f = static_cast<std::size_t>(frame);
    moment_of_frame[frame] = static_cast<int>(moments.size());
    moments.push_back({observations.frames[f], solution.state.T_map_rig[f]});
  }
  return moments;
}

MappedView mapped_view(const Observations& observations, const PartSolution& solution, const TagView& view) {
  const auto camera = static_cast<std::size_t>(view.camera);
  const MapState& state = solution.state;
  MappedView mapped;
  mapped.tag =
      static_cast<int>(std::ranges::lower_bound(solution.part.tags, view.tag) - solution.part.tags.begin());
  mapped.camera = view.camera;
  mapped.T_camera_tag = state.cameras[camera].T_camera_rig *
                        state.T_map_rig[static_cast<std::size_t>(view.frame)].inverse() *
                        state.T_map_tag[static_cast<std::size_t>(view.tag)];
  mapped.corners_px = view.corners_px;
  bool is_valid = false;
  Vector8d residual_px;
  mapped.whitened = whitened_residual(observations, view, state, is_valid, &residual_px);
  for (std::size_t corner = 0; corner < kNumCorners; ++corner)
    mapped.residuals_px[corner] = residual_px.segment<2>(2 * static_cast<Eigen::Index>(corner));
  return mapped;
}

/// Of the part's views on average: in units of EdgeNoise, whatever their detector claims.
CornerNoise usual_noise(const Observations& observations, const PartSolution& solution,
                        const CalibrationOptions& options) {
  Eigen::Array2d claimed = Eigen::Array2d::Zero();  // variances: of sums, of differences
  for (const std::size_t v : solution.part.views) {
    const Matrix8d in_model = observations.views[v].by_model_errors.inverse();
    const double scale = scale_by_claim(observations.views[v], solution.state.noise.beyond_px);
    const Vector8d variances = scale * scale * in_model.rowwise().squaredNorm();
    for (Eigen::Index i = 0; i < 8; ++i) claimed[i % 2] += 0.25 * variances[i];
  }
  claimed = (claimed / static_cast<double>(solution.part.views.size())).sqrt();
  const NoiseScale& measured = solution.state.noise;
  return {options.corner_sigma_px, options.edge_end_correlation, measured.sum * claimed[0],
          measured.difference * claimed[1]};
}

}  // namespace

MapEvidence part_evidence(const Observations& observations, const PartSolution& solution,
                          const CalibrationOptions& options) {
  MapEvidence evidence;
  std::map<int, int> moment_of_frame;
  evidence.moments = moments_by_time(observations, solution, moment_of_frame);
  std::vector<int> kept(observations.tags.size(), 0);
  for (const std::size_t v : solution.part.views) {
    const TagView& view = observations.views[v];
    evidence.views.push_back(mapped_view(observations, solution, view));
    evidence.views.back().moment = moment_of_frame.at(view.frame);
    ++kept[static_cast<std::size_t>(view.tag)];
  }
  std::ranges::stable_sort(evidence.views, {}, &MappedView::moment);
  for (const int tag : solution.part.tags) {
    const auto t = static_cast<std::size_t>(tag);
    evidence.rejected.push_back(solution.views_offered_by_tag[t] - kept[t]);
  }
  evidence.noise = usual_noise(observations, solution, options);
  evidence.joint = solution.joint;
  return evidence;
}

}  // namespace apriltrack
