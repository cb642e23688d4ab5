#include "solve/bundle_adjustment.h"

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "model/corner_views.h"
#include "model/view_residual.h"
#include "solve/reduced_equations.h"

namespace apriltrack {
namespace {

// Of Ceres: nearly a Gauss-Newton step at once. By its own 1e4 the soft ways of a map, along which all tags
// bend a little, take eight small steps where five do.
constexpr double kFirstTrustRadius = 1e5;
constexpr std::size_t kMaxDenseTags = 200;  // above, the reduced system is mostly empty
// A frame that lies between its two poses of small tags is linear nowhere near, and the steps of all become
// as short as its own must be. So when many steps did not suffice, each frame and tag goes downhill by itself
// after a step, until that gains little (A. Ruhe, P. A. Wedin, "Algorithms for separable nonlinear least
// squares problems", 1980).
constexpr int kPlainIterations = 30;
constexpr double kNegligibleDecrease = 1e-3;  // of the cost of one number: a step of 0.03 sigmas
// Of Gauss and Newton's steps: one that gains so little, of the squares, is followed by none that gains any.
constexpr double kLastGain = 1e-8;
constexpr int kMostNearbySteps = 6;

/// Whitened reprojection errors of one view by the poses of its tag and of its frame's rig.
class ViewCost : public ceres::SizedCostFunction<8, 7, 7> {
 public:
  ViewCost(const RigCamera& camera, double size_m, const TagView& view, const Matrix8d& whitening)
      : camera_(camera), size_m_(size_m), view_(view), whitening_(whitening) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const bool wants_tag = jacobians != nullptr && jacobians[0] != nullptr;
    const bool wants_rig = jacobians != nullptr && jacobians[1] != nullptr;
    Vector8d residual_px;
    Matrix8x6d by_tag, by_rig;
    if (!view_residual(camera_, size_m_, view_, from_block(blocks[1]), from_block(blocks[0]), &residual_px,
                       wants_rig ? &by_rig : nullptr, wants_tag ? &by_tag : nullptr))
      return false;  // the solver shortens its step
    Eigen::Map<Vector8d> whitened(residuals);
    whitened = whitening_.lazyProduct(residual_px);
    if (wants_tag) write_jacobian(whitening_.lazyProduct(by_tag), blocks[0], jacobians[0]);
    if (wants_rig) write_jacobian(whitening_.lazyProduct(by_rig), blocks[1], jacobians[1]);
    return true;
  }

 private:
  static void write_jacobian(const Matrix8x6d& by_tangent, const double* block, double* jacobian) {
    Eigen::Map<Eigen::Matrix<double, 8, 7, Eigen::RowMajor>> by_ambient(jacobian);
    by_ambient = by_tangent.lazyProduct(tangent_from_ambient(block));
  }

  const RigCamera& camera_;
  const double size_m_;
  const TagView& view_;
  Matrix8d whitening_;
};

class StopCallback : public ceres::IterationCallback {
 public:
  explicit StopCallback(const ShouldStop& should_stop) : should_stop_(should_stop) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return should_stop_ && should_stop_() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const ShouldStop& should_stop_;
};

/// A fit that another one follows, as a robust one, by which outliers are chosen, ends where a step gains
/// less than counts, unless it creeps, and may gain as much by each of many more.
class EnoughCallback : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    constexpr double kFast = 0.5;  // of the step before
    if (!step.step_is_successful || step.iteration == 0) return ceres::SOLVER_CONTINUE;
    const double before = std::exchange(decrease_, step.cost_change);
    return step.cost_change < kNegligibleDecrease && step.cost_change < kFast * before
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  double decrease_ = 0.0;
};

bool can_be_projected(const Observations& observations, const TagView& view, const MapState& state) {
  Vector8d residual_px;
  return residual_of(observations, view, state, &residual_px);
}

}  // namespace

AdjustmentOptions adjustment_options(const CalibrationOptions& options, double loss_scale) {
  return {
      .loss_scale = loss_scale, .max_iterations = options.max_iterations, .should_stop = options.should_stop};
}

BundleProblem::Blocks BundleProblem::make_blocks(const std::set<int>& keys, const std::vector<Pose>& poses) {
  Blocks result;
  for (const int key : keys) {
    result.index[key] = result.blocks.size();
    result.blocks.push_back(to_block(poses[static_cast<std::size_t>(key)]));
  }
  return result;
}

void BundleProblem::add_blocks(Blocks& blocks, ceres::Manifold* manifold) {
  for (PoseBlock& block : blocks.blocks) problem_.AddParameterBlock(block.data(), 7, manifold);
}

BundleProblem::BundleProblem(const Observations& observations, const std::vector<std::size_t>& views,
                             const std::vector<int>& free_tags, const MapState& state, double loss_scale) {
  std::vector<const TagView*> used;
  std::set<int> tags, frames;
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    if (!can_be_projected(observations, view, state)) continue;
    used.push_back(&view);
    tags.insert(view.tag);
    frames.insert(view.frame);
  }
  if (used.empty()) return;
  tags_ = make_blocks(tags, state.T_map_tag);
  frames_ = make_blocks(frames, state.T_map_rig);
  auto* manifold = new Se3Manifold;  // the problem owns both, and frees each once
  ceres::LossFunction* loss = loss_scale > 0.0 ? new ceres::CauchyLoss(loss_scale) : nullptr;
  add_blocks(tags_, manifold);
  add_blocks(frames_, manifold);
  for (const TagView* view : used) {
    auto* cost = new ViewCost(state.cameras[static_cast<std::size_t>(view->camera)],
                              observations.sizes_m[static_cast<std::size_t>(view->tag)], *view,
                              whitening(*view, state));
    problem_.AddResidualBlock(cost, loss, tag_block(view->tag),
                              frames_.blocks[frames_.index.at(view->frame)].data());
  }
  is_robust_ = loss != nullptr;
  for (const int tag : tags) {
    if (std::find(free_tags.begin(), free_tags.end(), tag) == free_tags.end())
      problem_.SetParameterBlockConstant(tag_block(tag));
  }
}

ceres::Solver::Options BundleProblem::solver_options() {
  ceres::Solver::Options options;
  options.initial_trust_region_radius = kFirstTrustRadius;
  options.function_tolerance = 1e-10;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-10;
  options.num_threads = 1;  // Ceres adds up in the order in which threads finish: results would differ
  options.logging_type = ceres::SILENT;
  options.linear_solver_type =
      tags_.blocks.size() <= kMaxDenseTags ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (PoseBlock& block : frames_.blocks) ordering->AddElementToGroup(block.data(), 0);
  for (PoseBlock& block : tags_.blocks) ordering->AddElementToGroup(block.data(), 1);
  options.linear_solver_ordering = ordering;
  options.inner_iteration_ordering = std::make_shared<ceres::ParameterBlockOrdering>(*ordering);
  return options;
}

AdjustmentSummary BundleProblem::solve(const AdjustmentOptions& how) {
  if (tags_.blocks.empty()) return {false, false, 0.0, "no view can be projected"};
  StopCallback stop(how.should_stop);
  EnoughCallback enough;
  ceres::Solver::Options options = solver_options();
  options.callbacks.push_back(&stop);
  if (how.ends_early || is_robust_) options.callbacks.push_back(&enough);
  options.max_num_iterations = std::min(how.max_iterations, kPlainIterations);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  if (summary.termination_type == ceres::NO_CONVERGENCE && how.max_iterations > kPlainIterations) {
    options.max_num_iterations = how.max_iterations - kPlainIterations;
    options.use_inner_iterations = true;
    options.function_tolerance =
        std::max(options.function_tolerance, kNegligibleDecrease / problem_.NumResiduals());
    ceres::Solve(options, &problem_, &summary);
  }
  if (summary.termination_type == ceres::USER_FAILURE) throw Stopped();
  const bool has_converged =
      summary.termination_type == ceres::CONVERGENCE || summary.termination_type == ceres::USER_SUCCESS;
  return {summary.IsSolutionUsable(), has_converged, summary.final_cost, summary.message};
}

void BundleProblem::write_back(MapState& state) const {
  for (const auto& [tag, i] : tags_.index)
    state.T_map_tag[static_cast<std::size_t>(tag)] = from_block(tags_.blocks[i].data());
  for (const auto& [frame, i] : frames_.index)
    state.T_map_rig[static_cast<std::size_t>(frame)] = from_block(frames_.blocks[i].data());
}

namespace {

/// nullopt where the minimum is not near, or not determined.
std::optional<AdjustmentSummary> adjust_nearby(const Observations& observations,
                                               const std::vector<std::size_t>& views,
                                               const std::set<int>& free_tags,
                                               const AdjustmentOptions& options, MapState& state) {
  constexpr int kHeld = -1;
  MapState next = state;
  double last_squares = std::numeric_limits<double>::infinity();
  for (int i = 0; i < std::min(options.max_iterations, kMostNearbySteps); ++i) {
    if (options.should_stop && options.should_stop()) throw Stopped();
    std::vector<LinearView> linear = corner_views(observations, views, next);
    double squares = 0.0;
    for (LinearView& view : linear) {
      squares += view.residual.squaredNorm();
      if (!free_tags.contains(view.tag)) view.tag = kHeld;
    }
    if (linear.size() != views.size() || !(squares <= last_squares)) return std::nullopt;
    last_squares = squares;
    const auto steps = solve_steps(linear, free_tags.empty() ? std::nullopt : std::optional(kHeld));
    if (!steps) return std::nullopt;
    take(*steps, next);
    if (steps->gain > (options.ends_early ? 2.0 * kNegligibleDecrease : kLastGain * squares)) continue;
    state = std::move(next);
    return AdjustmentSummary{true, true, 0.5 * (squares - steps->gain), "it was near"};
  }
  return std::nullopt;
}

}  // namespace

AdjustmentSummary adjust(const Observations& observations, const std::vector<std::size_t>& views,
                         const std::vector<int>& free_tags, const AdjustmentOptions& options,
                         MapState& state) {
  if (options.loss_scale == 0.0) {
    const std::set<int> free(free_tags.begin(), free_tags.end());
    if (const auto summary = adjust_nearby(observations, views, free, options, state)) return *summary;
  }
  BundleProblem problem(observations, views, free_tags, state, options.loss_scale);
  const AdjustmentSummary summary = problem.solve(options);
  if (summary.is_usable) problem.write_back(state);
  return summary;
}

bool settle_poses(const PartTask& task, const Part& part, int held_tag, MapState& state, bool ends_early) {
  AdjustmentOptions how = adjustment_options(task.options);
  how.ends_early = ends_early;
  const AdjustmentSummary summary =
      adjust(task.observations, part.views, free_tags(part, held_tag), how, state);
  return summary.is_usable && summary.has_converged;
}

}  // namespace apriltrack
