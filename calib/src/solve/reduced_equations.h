#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "model/map_state.h"
#include "numerics/linear_view.h"

namespace apriltrack {

/// A step of all poses, right perturbations.
struct PoseSteps {
  std::map<int, Vector6d> tags;
  std::map<int, Vector6d> frames;
  /// Squared standard deviations that the tags move by, per unknown; the frames, where no tag does.
  double worth = 0.0;
  double gain = 0.0;  ///< By which the sum of squares falls, to first order.
};

/// Least squares over all tags but `held_tag` and all frames, frames eliminated, the rest by a sparse
/// Cholesky factor. No held tag: tags stay, and each frame steps alone. nullopt when the views leave a pose
/// undetermined.
std::optional<PoseSteps> solve_steps(const std::vector<LinearView>& views, std::optional<int> held_tag);

/// Moves the poses.
void take(const PoseSteps& steps, MapState& state);

}  // namespace apriltrack
