#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "solve/camera_parameters.h"
#include "uncertainty/linear_part.h"

namespace apriltrack {

/// A parameter as it was estimated.
struct EstimatedParameter {
  CameraParameter parameter;
  double value = 0.0;  ///< How far from what was given.
  double sigma = 0.0;
};

/// Cameras and poses together: a step of the cameras with all poses following, then the poses alone, until
/// neither moves. The cameras of the task are what was known before, with the parameters' sigmas.
class CameraFit {
 public:
  /// task, parameters: outlive this.
  CameraFit(const PartTask& task, const CameraParameters& parameters, Part part, int held_tag)
      : task_(task), parameters_(parameters), part_(std::move(part)), held_tag_(held_tag) {}

  /// False where it does not settle.
  bool run(MapState& state);
  /// How far from the cameras as they are they would go, to first order. nullopt where the views do not tell.
  std::optional<std::vector<EstimatedParameter>> look(const MapState& state);

  /// Of the last run or look.
  std::vector<EstimatedParameter> estimates() const;
  /// Of the estimates, in their units.
  Eigen::MatrixXd covariance() const;
  /// Log odds, by the views alone, that what `before` has of lenses and places as given is not so, but off by
  /// what the sigmas expect: the density that prior and posterior have where nothing is off (Dickey, Ann.
  /// Math. Statist. 42, 1971, equation 1.1). What `before` has corrected already does not count, nor do
  /// detectors' edges, which are in no file. -infinity where that cannot be told; infinity where nothing is
  /// as given.
  double log_odds_of_change(const MapState& before) const;

 private:
  Eigen::VectorXd already_moved(const MapState& state) const;
  std::optional<Eigen::VectorXd> step_of_cameras(const MapState& state);
  bool move(const Eigen::VectorXd& step, MapState& state);

  const PartTask& task_;
  const CameraParameters& parameters_;
  Part part_;
  int held_tag_;
  Eigen::VectorXd total_, sigmas_;  ///< In units of the parameters' sigmas.
  Eigen::MatrixXd covariance_;
  ErrorScale scale_;
  double noise_variance_ = 1.0;  ///< As the parameters of cameras follow it.
  int step_number_ = 0;
};

}  // namespace apriltrack
