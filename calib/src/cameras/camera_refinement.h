#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "initialise/part_adjustment.h"
#include "solve/camera_fit.h"

namespace apriltrack {

struct CameraRefinement {
  bool is_accepted = false;
  std::string reason;  ///< Why not, or not all that was asked for.
  std::vector<EstimatedParameter> estimates;
  Eigen::MatrixXd covariance;  ///< Of the estimates, in their order and units.
  /// How far frames that the map was not made from disagree with it, in standard deviations (root mean
  /// square): before, and with a map and cameras refined from the others.
  double held_out_before = 0.0, held_out_after = 0.0;
};

CameraParameters parameters_of(const CameraRefinement& cameras);

/// That see the part, by their indices.
std::vector<int> cameras_of(const Observations& observations, const Part& part);

/// How the views depend on the errors of what was estimated, as independent ones of variance one. What map
/// the views make had no part in the estimates.
std::vector<ParameterView> independent_errors(const Observations& observations,
                                              const std::vector<std::size_t>& views, const MapState& state,
                                              const CameraRefinement& estimated);

/// Estimates parameters of the cameras together with all poses. They are taken over, into `solved`, only
/// where frames that took no part agree better with them, by more than chance and by the share `least_gain`;
/// else all stays as it is. Below 0, nothing is held out: the cameras of `solved` are other ones already.
CameraRefinement refine_cameras(const PartTask& task, const Part& part, const CameraParameters& parameters,
                                double least_gain, AdjustedPart& solved, const ParallelFor& parallel);

/// What the views say of parameters that are not taken over, to first order: how far they are from the
/// cameras of `solved`. The covariance is about these, not about the estimates: a map by them errs by that.
std::optional<CameraRefinement> open_parameters(const CameraFit& fit, const IsAsked& is_asked);
std::optional<CameraRefinement> open_parameters(const PartTask& task, const CameraParameters& parameters,
                                                const AdjustedPart& solved);

}  // namespace apriltrack
