#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "model/map_state.h"
#include "solve/camera_parameters.h"

namespace apriltrack {

/// A lens, and the poses of single views by it.
struct Lens {
  RigCamera camera;
  Eigen::VectorXd total;  ///< How far from the file's, in sigmas of the parameters.
  MapState state;
};

/// Least squares over a lens by views each by itself: six of a view's eight numbers are spent on its pose,
/// two are left for the lens. Robust; numbers of the file's lens are little known.
class LensFit {
 public:
  /// views: of one camera, into `observations`. file: that camera, as it is stated.
  LensFit(const Observations& observations, const RigCamera& file, const std::vector<std::size_t>& views,
          const ParallelFor& parallel);

  const RigCamera& file() const { return file_; }
  /// start: as far from the file's as it is.
  Lens lens_of(const RigCamera& start);

  /// In units of the noise that is expected, or found, where that is more.
  double noise(const Lens& lens) const;
  /// Half the robust squares of what the poses leave, and of how far the lens is from the file's.
  double cost(const Lens& lens, double noise) const;

  struct Step {
    Eigen::VectorXd by;  ///< In sigmas of the parameters, one of them at most.
    double gain = 0.0;   ///< By how much the cost would fall by all of it, to first order.
  };
  Step step(const Lens& lens, double noise) const;
  /// False, and `lens` as it was, where no part of the step makes the views agree better.
  bool move(Eigen::VectorXd step, double noise, Lens& lens);

 private:
  /// What a view leaves of its residual and of the derivatives, whatever its pose.
  struct Remains {
    Vector8d residual;
    Eigen::MatrixXd by_parameter;
  };

  std::optional<Lens> moved_by(const Lens& lens, const Eigen::VectorXd& step);
  MapState state_by(const RigCamera& camera);
  double squares_of(const MapState& state, std::size_t view) const;
  std::vector<Remains> remains(const MapState& state) const;

  Observations single_;
  RigCamera file_;
  CameraParameters parameters_;
  const ParallelFor& parallel_;
  std::vector<std::size_t> views_;
};

}  // namespace apriltrack
