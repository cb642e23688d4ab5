#include "solve/reduced_equations.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <utility>

namespace apriltrack {
namespace {

/// One frame's own equations, and its coupling with each tag that it shows.
struct FrameEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  std::map<int, Matrix6d> by_tag;
};

using FramesEquations = std::map<int, FrameEquations>;

class TagEquationsSum {
 public:
  void add(int a, int b, const Matrix6d& block) {
    blocks_.try_emplace({a, b}, Matrix6d::Zero()).first->second += block;
  }
  void add(int tag, const Vector6d& gradient) {
    gradients_.try_emplace(tag, Vector6d::Zero()).first->second += gradient;
  }

  /// The tags' steps; nothing where they are undetermined.
  std::optional<std::map<int, Vector6d>> solve(double* gain) const {
    std::map<int, Vector6d> steps;
    *gain = 0.0;
    if (gradients_.empty()) return steps;
    std::map<int, Eigen::Index> offsets;
    for (const auto& [tag, gradient] : gradients_)
      offsets[tag] = 6 * static_cast<Eigen::Index>(offsets.size());
    const auto size = 6 * static_cast<Eigen::Index>(offsets.size());
    Eigen::VectorXd gradient(size);
    for (const auto& [tag, offset] : offsets) gradient.segment<6>(offset) = gradients_.at(tag);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix(offsets, size));
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return std::nullopt;
    const Eigen::VectorXd step = -factor.solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    *gain = -step.dot(gradient);
    for (const auto& [tag, offset] : offsets) steps[tag] = step.segment<6>(offset);
    return steps;
  }

 private:
  Eigen::SparseMatrix<double> matrix(const std::map<int, Eigen::Index>& offsets, Eigen::Index size) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(36 * blocks_.size());
    for (const auto& [tags, block] : blocks_) {
      for (int row = 0; row < 6; ++row) {
        for (int column = 0; column < 6; ++column)
          entries.emplace_back(static_cast<int>(offsets.at(tags.first)) + row,
                               static_cast<int>(offsets.at(tags.second)) + column, block(row, column));
      }
    }
    Eigen::SparseMatrix<double> result(size, size);
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
  }

  std::map<std::pair<int, int>, Matrix6d> blocks_;
  std::map<int, Vector6d> gradients_;
};

void eliminate(const FrameEquations& frame, const Eigen::LDLT<Matrix6d>& factor, TagEquationsSum& tags) {
  for (const auto& [a, coupling_a] : frame.by_tag) {
    const Matrix6d eliminated = factor.solve(coupling_a.transpose()).transpose();
    tags.add(a, Vector6d(-eliminated * frame.g));
    for (const auto& [b, coupling_b] : frame.by_tag) {
      if (b > a) break;  // the factor reads the lower triangle
      tags.add(a, b, Matrix6d(-eliminated * coupling_b.transpose()));
    }
  }
}

}  // namespace

std::optional<PoseSteps> solve_steps(const std::vector<LinearView>& views, std::optional<int> held_tag) {
  FramesEquations frames;
  TagEquationsSum tags;
  for (const LinearView& view : views) {
    FrameEquations& frame = frames[view.frame];
    frame.H += view.by_rig.transpose() * view.by_rig;
    frame.g += view.by_rig.transpose() * view.residual;
    if (!held_tag || view.tag == *held_tag) continue;
    frame.by_tag.try_emplace(view.tag, Matrix6d::Zero()).first->second +=
        view.by_tag.transpose() * view.by_rig;
    tags.add(view.tag, view.tag, Matrix6d(view.by_tag.transpose() * view.by_tag));
    tags.add(view.tag, Vector6d(view.by_tag.transpose() * view.residual));
  }
  std::map<int, Eigen::LDLT<Matrix6d>> factors;
  for (const auto& [index, frame] : frames) {
    const Eigen::LDLT<Matrix6d>& factor = factors[index].compute(frame.H);
    if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) return std::nullopt;
    eliminate(frame, factor, tags);
  }
  PoseSteps steps;
  auto of_tags = tags.solve(&steps.gain);
  if (!of_tags) return std::nullopt;
  steps.tags = std::move(*of_tags);
  const double by_tags = steps.gain;
  for (const auto& [index, frame] : frames) {
    const Eigen::LDLT<Matrix6d>& factor = factors.at(index);
    Vector6d gradient = frame.g;
    for (const auto& [tag, coupling] : frame.by_tag) gradient += coupling.transpose() * steps.tags.at(tag);
    steps.gain += frame.g.dot(factor.solve(frame.g));
    steps.frames[index] = -factor.solve(gradient);
  }
  steps.worth = steps.tags.empty() ? steps.gain / (6.0 * static_cast<double>(frames.size()))
                                   : by_tags / (6.0 * static_cast<double>(steps.tags.size()));
  return steps;
}

void take(const PoseSteps& steps, MapState& state) {
  const auto move = [](const std::map<int, Vector6d>& all, std::vector<Pose>& poses) {
    for (const auto& [index, step] : all) {
      Pose& pose = poses[static_cast<std::size_t>(index)];
      pose = pose * Pose::exp(step);
    }
  };
  move(steps.tags, state.T_map_tag);
  move(steps.frames, state.T_map_rig);
}

}  // namespace apriltrack
