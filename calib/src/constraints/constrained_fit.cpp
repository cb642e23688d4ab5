#include "constraints/constrained_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

namespace apriltrack {
namespace {

constexpr int kMostIterations = 60;
constexpr double kStillPose = 1e-11;   // m or rad
constexpr double kStillEnough = 1e-8;  // at the last iteration
constexpr double kMostTurn_rad = 0.5;  // of a step
constexpr double kRankTolerance = 1e-10;

/// Of 3x3, symmetric; eigenvalues under `least` count as none.
Eigen::Matrix3d pseudoinverse(const Eigen::Matrix3d& matrix, double least) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  Eigen::Vector3d inverse = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] > least) inverse[i] = 1.0 / solver.eigenvalues()[i];
  }
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

/// scales: the largest diagonal entry that each block had before others were eliminated.
Eigen::MatrixXd blockwise_inverse_from(const Eigen::MatrixXd& matrix, const std::vector<double>& scales,
                                       std::size_t first) {
  const Eigen::Index rest = matrix.rows() - 3;
  const Eigen::Matrix3d own = pseudoinverse(matrix.topLeftCorner<3, 3>(), kRankTolerance * scales[first]);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(matrix.rows(), matrix.rows());
  result.topLeftCorner<3, 3>() = own;
  if (rest == 0) return result;
  const Eigen::MatrixXd follows = own * matrix.topRightCorner(3, rest);
  const Eigen::MatrixXd others = blockwise_inverse_from(
      matrix.bottomRightCorner(rest, rest) - matrix.bottomLeftCorner(rest, 3) * follows, scales, first + 1);
  result.bottomRightCorner(rest, rest) = others;
  result.topRightCorner(3, rest) = -follows * others;
  result.bottomLeftCorner(rest, 3) = result.topRightCorner(3, rest).transpose();
  result.topLeftCorner<3, 3>() += follows * others * follows.transpose();
  return result;
}

/// Where the unknowns' columns are: the planes that constraints name, three each, then the frame.
struct UnknownColumns {
  explicit UnknownColumns(std::span<const BoundConstraint> constraints) {
    for (const BoundConstraint& bound : constraints) {
      has_frame = has_frame || is_of_frame(*bound.constraint);
      if (bound.plane >= 0) planes.try_emplace(bound.plane, kPlaneUnknowns * static_cast<int>(planes.size()));
    }
  }
  int frame() const { return kPlaneUnknowns * static_cast<int>(planes.size()); }
  int size() const { return frame() + (has_frame ? 6 : 0); }

  std::map<int, int> planes;
  bool has_frame = false;
};

/// One linearisation, and the step that it asks for.
class ConstraintSystem {
 public:
  ConstraintSystem(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior,
                   ConstraintState state)
      : constraints_(constraints), prior_(prior), columns_(constraints) {
    fit_.state = std::move(state);
    fit_.has_frame = columns_.has_frame;
  }

  /// moved: of the tags, from where the images alone have them to where they are in the state.
  void linearise_at(const Eigen::VectorXd& moved) {
    fit_.constraints.clear();
    fit_.first_rows.clear();
    Eigen::Index rows = 0;
    for (const BoundConstraint& bound : constraints_) {
      fit_.constraints.push_back(linearise(bound, fit_.state));
      fit_.first_rows.push_back(rows);
      rows += fit_.constraints.back().residual.size();
    }
    fit_.by_tags.resize(rows, prior_.covariance.rows());
    entries_.clear();
    by_unknowns_ = Eigen::MatrixXd::Zero(rows, columns_.size());
    fit_.disagreement.resize(rows);
    for (std::size_t i = 0; i < constraints_.size(); ++i) place(i);
    fit_.by_tags.setFromTriplets(entries_.begin(), entries_.end());
    fit_.disagreement -= fit_.by_tags * moved;
  }

  /// with_precision: also what only the last step needs, and takes longest.
  void solve(bool with_precision) {
    const Eigen::Index rows = fit_.disagreement.size();
    with_rows_ = prior_.covariance * fit_.by_tags.transpose();
    Eigen::MatrixXd variance = fit_.by_tags * with_rows_;
    variance.diagonal().array() += 1.0;
    const Eigen::LLT<Eigen::MatrixXd> factor(variance);
    const Eigen::MatrixXd weighted = factor.solve(by_unknowns_);
    if (with_precision) fit_.precision = factor.solve(Eigen::MatrixXd::Identity(rows, rows));
    fit_.push = factor.solve(fit_.disagreement);
    step_ = Eigen::VectorXd::Zero(columns_.size());
    if (columns_.size() == 0) return;
    const Eigen::MatrixXd information = by_unknowns_.transpose() * weighted;
    const Eigen::MatrixXd covariance = blockwise_inverse(information);
    step_ = -covariance * (by_unknowns_.transpose() * fit_.push);
    if (with_precision) fit_.precision -= weighted * (covariance * weighted.transpose());
    fit_.push += weighted * step_;
    if (!columns_.has_frame) return;
    fit_.frame_covariance = covariance.bottomRightCorner<6, 6>();
    fit_.frame_coupling = weighted * covariance.rightCols<6>();
    find_open_directions(information, covariance);
  }

  /// Takes the step; the largest number of it, m or rad.
  double advance(Eigen::VectorXd& moved) {
    const Eigen::VectorXd next = -(with_rows_ * fit_.push);
    double turn = columns_.has_frame ? step_.tail<3>().norm() : 0.0;
    for (const auto& [plane, column] : columns_.planes)
      turn = std::max(turn, step_.segment<2>(column + 1).norm());
    const double share = turn > kMostTurn_rad ? kMostTurn_rad / turn : 1.0;
    const double largest = std::max(next.size() > 0 ? (next - moved).cwiseAbs().maxCoeff() : 0.0,
                                    step_.size() > 0 ? step_.cwiseAbs().maxCoeff() : 0.0);
    moved += share * (next - moved);
    for (const auto& [tag, offset] : prior_.offsets) {
      const auto t = static_cast<std::size_t>(tag);
      fit_.state.T_held_tag[t] = prior_.T_held_tag[t] * Pose::exp(moved.segment<6>(offset));
    }
    for (const auto& [plane, column] : columns_.planes) {
      Pose& pose = fit_.state.T_held_plane[static_cast<std::size_t>(plane)];
      pose = moved_plane(pose, share * step_.segment<kPlaneUnknowns>(column));
    }
    if (columns_.has_frame)
      fit_.state.T_map_held = fit_.state.T_map_held * Pose::exp(Vector6d(share * step_.tail<6>()));
    return largest;
  }

  ConstrainedFit take(bool has_settled) {
    fit_.has_settled = has_settled;
    return std::move(fit_);
  }

 private:
  void place(std::size_t i) {
    const BoundConstraint& bound = constraints_[i];
    const LinearConstraint& linear = fit_.constraints[i];
    const Eigen::Index row = fit_.first_rows[i], rows = linear.residual.size();
    fit_.disagreement.segment(row, rows) = linear.residual;
    for (std::size_t t = 0; t < bound.tags.size(); ++t) {
      if (const auto offset = prior_.offsets.find(bound.tags[t]); offset != prior_.offsets.end())
        place_block(row, offset->second, linear.by_tag[t]);
    }
    if (bound.plane >= 0)
      by_unknowns_.block(row, columns_.planes.at(bound.plane), rows, kPlaneUnknowns) = linear.by_plane;
    if (columns_.has_frame) by_unknowns_.block(row, columns_.frame(), rows, 6) = linear.by_frame;
  }

  void place_block(Eigen::Index first_row, Eigen::Index first_column, const Eigen::MatrixXd& block) {
    for (Eigen::Index column = 0; column < block.cols(); ++column) {
      for (Eigen::Index row = 0; row < block.rows(); ++row) {
        if (block(row, column) != 0.0)
          entries_.emplace_back(first_row + row, first_column + column, block(row, column));
      }
    }
  }

  void find_open_directions(const Eigen::MatrixXd& information, const Eigen::MatrixXd& inverse) {
    // What inverse * information does not give back.
    const Eigen::MatrixXd lost =
        Eigen::MatrixXd::Identity(information.rows(), information.cols()) - inverse * information;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(lost.bottomRightCorner<6, 6>(), Eigen::ComputeThinU);
    const auto rank = (svd.singularValues().array() > 1e-3).count();
    fit_.open_directions = svd.matrixU().leftCols(rank);
  }

  std::span<const BoundConstraint> constraints_;
  const ConstraintPrior& prior_;
  UnknownColumns columns_;
  ConstrainedFit fit_;
  std::vector<Eigen::Triplet<double, Eigen::Index>> entries_;  // of by_tags
  Eigen::MatrixXd by_unknowns_;
  Eigen::MatrixXd with_rows_;  // covariance A'
  Eigen::VectorXd step_;
};

}  // namespace

Eigen::MatrixXd blockwise_inverse(const Eigen::MatrixXd& matrix) {
  std::vector<double> scales;
  for (Eigen::Index block = 0; block < matrix.rows(); block += 3)
    scales.push_back(std::max(matrix.diagonal().segment<3>(block).maxCoeff(), 1e-300));
  return blockwise_inverse_from(matrix, scales, 0);
}

Eigen::VectorXd row_variances(const BoundConstraint& bound, const LinearConstraint& linear,
                              const ConstraintPrior& prior) {
  Eigen::VectorXd variances = Eigen::VectorXd::Ones(linear.residual.size());
  for (std::size_t a = 0; a < bound.tags.size(); ++a) {
    const auto offset_a = prior.offsets.find(bound.tags[a]);
    if (offset_a == prior.offsets.end()) continue;
    for (std::size_t b = 0; b < bound.tags.size(); ++b) {
      const auto offset_b = prior.offsets.find(bound.tags[b]);
      if (offset_b == prior.offsets.end()) continue;
      const Matrix6d covariance = prior.covariance.block<6, 6>(offset_a->second, offset_b->second);
      variances += (linear.by_tag[a] * covariance).cwiseProduct(linear.by_tag[b]).rowwise().sum();
    }
  }
  return variances;
}

ConstrainedFit fit_constraints(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior,
                               ConstraintState start) {
  start.T_held_tag = prior.T_held_tag;
  ConstraintSystem system(constraints, prior, std::move(start));
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(prior.covariance.rows());
  double step = 0.0;
  for (int i = 0; i < kMostIterations; ++i) {
    system.linearise_at(moved);
    system.solve(false);
    step = system.advance(moved);
    if (step < kStillPose) break;
  }
  system.linearise_at(moved);
  system.solve(true);
  return system.take(step < kStillEnough);
}

ConstrainedFit look_at_constraints(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior,
                                   const ConstraintState& state) {
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(prior.covariance.rows());
  for (const auto& [tag, offset] : prior.offsets) {
    const auto t = static_cast<std::size_t>(tag);
    moved.segment<6>(offset) = (prior.T_held_tag[t].inverse() * state.T_held_tag[t]).log();
  }
  ConstraintSystem system(constraints, prior, state);
  system.linearise_at(moved);
  system.solve(true);
  return system.take(true);
}

}  // namespace apriltrack
