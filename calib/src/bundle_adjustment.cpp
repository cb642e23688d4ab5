#include "bundle_adjustment.h"

#include <ceres/loss_function.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <algorithm>

#include "view_residual.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMaxDenseTags = 200;  // above, the reduced system is mostly empty

/// Whitened reprojection errors of one view by the poses of its tag and of its frame's rig.
class ViewCost : public ceres::SizedCostFunction<8, 7, 7> {
 public:
  ViewCost(const RigCamera& camera, double size_m, const TagView& view)
      : camera_(camera), size_m_(size_m), view_(view) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const bool wants_tag = jacobians != nullptr && jacobians[0] != nullptr;
    const bool wants_rig = jacobians != nullptr && jacobians[1] != nullptr;
    Vector8d residual_px;
    Matrix8x6d by_tag, by_rig;
    if (!view_residual(camera_, size_m_, view_.corners_px, from_block(blocks[1]), from_block(blocks[0]),
                       &residual_px, wants_rig ? &by_rig : nullptr, wants_tag ? &by_tag : nullptr))
      return false;  // the solver shortens its step
    Eigen::Map<Vector8d> whitened(residuals);
    whitened = view_.whitening * residual_px;
    if (wants_tag) write_jacobian(view_.whitening * by_tag, blocks[0], jacobians[0]);
    if (wants_rig) write_jacobian(view_.whitening * by_rig, blocks[1], jacobians[1]);
    return true;
  }

 private:
  static void write_jacobian(const Matrix8x6d& by_tangent, const double* block, double* jacobian) {
    Eigen::Map<Eigen::Matrix<double, 8, 7, Eigen::RowMajor>> by_ambient(jacobian);
    by_ambient = by_tangent * tangent_from_ambient(block);
  }

  const RigCamera& camera_;
  const double size_m_;
  const TagView& view_;
};

bool can_be_projected(const Observations& observations, const TagView& view, const MapState& state) {
  Vector8d residual_px;
  return view_residual(observations.cameras[static_cast<std::size_t>(view.camera)],
                       observations.sizes_m[static_cast<std::size_t>(view.tag)], view.corners_px,
                       state.T_map_rig[static_cast<std::size_t>(view.frame)],
                       state.T_map_tag[static_cast<std::size_t>(view.tag)], &residual_px, nullptr, nullptr);
}

}  // namespace

BundleProblem::BundleProblem(const Observations& observations, const std::vector<std::size_t>& views,
                             const std::vector<int>& free_tags, const MapState& state, double loss_scale) {
  auto* manifold = new Se3Manifold;  // the problem owns it, and frees it once
  ceres::LossFunction* loss = loss_scale > 0.0 ? new ceres::CauchyLoss(loss_scale) : nullptr;
  const auto add_block = [&](std::map<int, PoseBlock>& blocks, int key, const Pose& pose) {
    const auto [entry, is_new] = blocks.try_emplace(key, to_block(pose));
    if (is_new) problem_.AddParameterBlock(entry->second.data(), 7, manifold);
    return entry->second.data();
  };
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    if (!can_be_projected(observations, view, state)) continue;
    double* tag = add_block(tags_, view.tag, state.T_map_tag[static_cast<std::size_t>(view.tag)]);
    double* rig = add_block(frames_, view.frame, state.T_map_rig[static_cast<std::size_t>(view.frame)]);
    problem_.AddResidualBlock(new ViewCost(observations.cameras[static_cast<std::size_t>(view.camera)],
                                           observations.sizes_m[static_cast<std::size_t>(view.tag)], view),
                              loss, tag, rig);
  }
  for (auto& [tag, block] : tags_) {
    if (std::find(free_tags.begin(), free_tags.end(), tag) == free_tags.end())
      problem_.SetParameterBlockConstant(block.data());
  }
  if (tags_.empty()) {  // nothing took them over
    delete manifold;
    delete loss;
  }
}

AdjustmentSummary BundleProblem::solve(int max_iterations) {
  if (tags_.empty()) return {false, false, 0.0, "no view can be projected"};
  ceres::Solver::Options options;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-10;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-10;
  options.num_threads = 1;  // Ceres adds up in the order in which threads finish: results would differ
  options.logging_type = ceres::SILENT;
  options.linear_solver_type = tags_.size() <= kMaxDenseTags ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (auto& [frame, block] : frames_) ordering->AddElementToGroup(block.data(), 0);
  for (auto& [tag, block] : tags_) ordering->AddElementToGroup(block.data(), 1);
  options.linear_solver_ordering = ordering;

  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  return {summary.IsSolutionUsable(), summary.termination_type == ceres::CONVERGENCE, summary.final_cost,
          summary.message};
}

void BundleProblem::write_back(MapState& state) const {
  for (const auto& [tag, block] : tags_)
    state.T_map_tag[static_cast<std::size_t>(tag)] = from_block(block.data());
  for (const auto& [frame, block] : frames_)
    state.T_map_rig[static_cast<std::size_t>(frame)] = from_block(block.data());
}

AdjustmentSummary adjust(const Observations& observations, const std::vector<std::size_t>& views,
                         const std::vector<int>& free_tags, const AdjustmentOptions& options,
                         MapState& state) {
  BundleProblem problem(observations, views, free_tags, state, options.loss_scale);
  const AdjustmentSummary summary = problem.solve(options.max_iterations);
  if (summary.is_usable) problem.write_back(state);
  return summary;
}

}  // namespace apriltrack
