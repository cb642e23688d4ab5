#pragma once

#include <optional>
#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/motion_fit.h"
#include "apriltrack/photometric/photometric_world.h"
#include "motion_equations.h"

namespace apriltrack {

/// What the motion so far says of a state; nothing where nothing is known.
class PriorTerm {
 public:
  explicit PriorTerm(const std::optional<MotionBelief>& belief);

  double cost(const MotionState& state) const;
  /// by_state: of a state.
  void add_to(MotionEquations& by_state, const MotionState& state) const;

 private:
  const std::optional<MotionBelief>& belief_;
  Matrix12d information_ = Matrix12d::Zero();
};

/// What detected corners say of a state, robustly.
class CornerTerm {
 public:
  CornerTerm(const PhotometricWorld& world, const std::vector<CornerObservation>& corners)
      : world_(world), corners_(corners) {}

  double cost(const MotionState& state) const;
  /// by_view: of the camera's view of the map and its rate.
  void add_to(MotionEquations& by_view, const MotionState& state) const;

 private:
  const PhotometricWorld& world_;
  const std::vector<CornerObservation>& corners_;
};

}  // namespace apriltrack
