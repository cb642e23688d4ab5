#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/stop.h"
#include "model/map_state.h"
#include "model/solve_context.h"
#include "numerics/se3_manifold.h"

namespace apriltrack {

struct AdjustmentOptions {
  /// Scale of the Cauchy loss on a view's whitened residual norm (sqrt(8) for noise as expected); 0 = least
  /// squares.
  double loss_scale = 0.0;
  int max_iterations = 100;
  /// Ends where a step gains less than counts, unless it creeps; a robust fit always does.
  bool ends_early = false;
  ShouldStop should_stop = {};  ///< Asked after each iteration.
};

/// As a calibration's options want it.
AdjustmentOptions adjustment_options(const CalibrationOptions& options, double loss_scale = 0.0);

struct AdjustmentSummary {
  bool is_usable = false;  ///< The state is at least as good as before.
  bool has_converged = false;
  double cost = 0.0;  ///< Half the (robust) sum of squares.
  std::string message;
};

/// The reprojection errors of `views` as a Ceres problem over the poses of their tags and frames.
class BundleProblem {
 public:
  /// free_tags: tags whose poses vary; all others keep theirs, which fixes the gauge: at least one of them
  /// must be seen. Views that cannot be projected from `state` are left out. Keeps references to
  /// `observations` and to the cameras of `state`.
  BundleProblem(const Observations& observations, const std::vector<std::size_t>& views,
                const std::vector<int>& free_tags, const MapState& state, double loss_scale);

  /// The loss is the problem's own, whatever `how` has. Throws Stopped.
  AdjustmentSummary solve(const AdjustmentOptions& how);
  void write_back(MapState& state) const;

  ceres::Problem& problem() { return problem_; }
  double* tag_block(int tag) { return tags_.blocks[tags_.index.at(tag)].data(); }

 private:
  /// In one piece of memory, in the order of the keys: Ceres eliminates blocks in the order of their
  /// addresses, and results must not depend on where the heap happened to put them.
  struct Blocks {
    std::map<int, std::size_t> index;
    std::vector<PoseBlock> blocks;
  };

  ceres::Solver::Options solver_options();
  static Blocks make_blocks(const std::set<int>& keys, const std::vector<Pose>& poses);
  void add_blocks(Blocks& blocks, ceres::Manifold* manifold);

  bool is_robust_ = false;
  ceres::Problem problem_;
  Blocks tags_;
  Blocks frames_;
};

/// Near the minimum of the squares of views that can all be projected, by Gauss and Newton; elsewhere, and
/// robustly, by a BundleProblem. Throws Stopped; `state` is then as it was.
AdjustmentSummary adjust(const Observations& observations, const std::vector<std::size_t>& views,
                         const std::vector<int>& free_tags, const AdjustmentOptions& options,
                         MapState& state);

/// The same of a part, as its task wants it; whether it is done.
bool settle_poses(const PartTask& task, const Part& part, int held_tag, MapState& state,
                  bool ends_early = false);

}  // namespace apriltrack
