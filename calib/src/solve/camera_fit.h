#pragma once

#include <functional>
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

/// Parameters as they were estimated, and the covariance of that, in their units.
struct CameraEstimates {
  std::vector<EstimatedParameter> parameters;
  Eigen::MatrixXd covariance;
};

using IsAsked = std::function<bool(const CameraParameter&)>;

/// Cameras and poses together by Gauss and Newton, until no camera moves; where poses are not led downhill,
/// they settle alone in between. The cameras of the task are what was known before, with the parameters'
/// sigmas.
class CameraFit {
 public:
  /// Linearises at `start`. task: outlives this.
  CameraFit(const PartTask& task, CameraParameters parameters, Part part, int held_tag, MapState start);
  CameraFit(const CameraFit&) = delete;
  CameraFit& operator=(const CameraFit&) = delete;

  /// Before it is run: the share by which the residuals would fall, to first order.
  double promised_gain() const;
  /// Before it is run: how far from the cameras as they are those of the parameters would go that are asked
  /// for, to first order, the others staying. nullopt where the views do not tell.
  std::optional<CameraEstimates> look(const IsAsked& is_asked) const;
  /// False where it does not settle.
  bool run();

  const MapState& state() const { return state_; }
  /// Of the last run.
  CameraEstimates estimates() const { return in_units({total_, covariance_}, parameters_); }
  /// Log odds, by the views alone, that what `before` has of lenses and places as given is not so, but off by
  /// what the sigmas expect: the density that prior and posterior have where nothing is off (Dickey, Ann.
  /// Math. Statist. 42, 1971, equation 1.1). What `before` has corrected already does not count, nor do
  /// detectors' edges, which are in no file. -infinity where that cannot be told; infinity where nothing is
  /// as given.
  double log_odds_of_change(const MapState& before) const;

 private:
  /// In units of the parameters' sigmas.
  struct Posterior {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;

    Eigen::VectorXd sigmas() const { return covariance.diagonal().cwiseMax(1e-16).cwiseSqrt(); }
  };

  static CameraEstimates in_units(const Posterior& posterior, const CameraParameters& parameters);
  void linearise();
  double squares() const;
  Eigen::VectorXd already_moved(const MapState& state) const;
  double noise_variance(const std::vector<ParameterView>& columns,
                        const ParameterInformation& of_cameras) const;
  std::optional<Posterior> posterior(const ParameterInformation& of_cameras, const Eigen::VectorXd& moved,
                                     double noise_variance) const;
  bool move(const Eigen::VectorXd& step);

  const PartTask& task_;
  CameraParameters parameters_;
  Part part_;
  int held_tag_;
  int most_seen_tag_ =
      0;  ///< What is known of cameras is the same whichever is held; scatter is about this one.
  MapState state_;
  std::vector<LinearView> views_;
  std::vector<ParameterView> columns_;
  std::optional<PoseInformation> poses_;  ///< None where the views leave a pose undetermined.
  ParameterInformation of_cameras_;
  ErrorScale scale_;
  double noise_variance_ = 1.0;  ///< As the parameters of cameras follow it.
  int num_scaled_ = 0;
  Eigen::VectorXd total_;  ///< In units of the parameters' sigmas.
  Eigen::MatrixXd covariance_;
};

}  // namespace apriltrack
