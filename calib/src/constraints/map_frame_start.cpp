#include "constraints/map_frame_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "numerics/cauchy_loss.h"

namespace apriltrack {
namespace {

constexpr int kMostFrameSteps = 60;
constexpr int kMostHalvings = 12;
constexpr double kMostFrameTurn_rad = 0.5;  // of a step
constexpr CauchyLoss kFrameLoss{3.0};       // sigmas
constexpr double kSame = 1e-3;              // of the cost
constexpr double kAboutAsGood = 4.5;        // of the cost, half a sum of squares: three sigmas
constexpr double kOtherTurn_rad = 0.1;
constexpr double kFarTurn_rad = 0.5;    // shows a tilt that heights which differ little tell to second order
constexpr double kSameTurn_rad = 1e-3;  // where two starts end that seek one minimum
constexpr double kThreeSigmas2 = 9.0;
constexpr double kOneSigma = 0.5;  // of the cost
constexpr double kOpen = 1e-3;     // of a unit direction, what is left of it
constexpr double kInLine = 0.01;   // centres off their line, of their spread along it

/// A frame, and how well it agrees.
struct FrameFit {
  Pose T_map_held;
  double cost = std::numeric_limits<double>::infinity();
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

/// What the inverse does not give back: directions that nothing determines.
Matrix6d lost_directions(const Matrix6d& information) {
  return Matrix6d::Identity() - blockwise_inverse(information) * information;
}

/// Cube rotations, least angle first.
std::vector<Eigen::Matrix3d> cube_rotations() {
  std::vector<Eigen::Matrix3d> rotations;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
      for (int row = 0; row < 3; ++row)
        R(row, axes[static_cast<std::size_t>(row)]) = (signs >> row & 1) != 0 ? -1.0 : 1.0;
      if (R.determinant() > 0.0) rotations.push_back(R);
    }
  } while (std::ranges::next_permutation(axes).found);
  std::ranges::stable_sort(rotations, std::greater<>{}, [](const Eigen::Matrix3d& R) { return R.trace(); });
  return rotations;
}

class FrameSearch {
 public:
  FrameSearch(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior) : prior_(prior) {
    for (const BoundConstraint& bound : constraints) {
      if (is_of_frame(*bound.constraint)) constraints_.push_back(bound);
    }
    state_.T_held_tag = prior.T_held_tag;
  }

  bool is_empty() const { return constraints_.empty(); }

  /// Whether the frame may be turned further than its linear equations say, or less far. Heights of tags in
  /// one upright plane are so: tilting the plane changes them to second order only, and to either side alike.
  bool is_turn_misjudged(const FrameFit& fit) {
    const Matrix6d covariance = blockwise_inverse(fit.information);
    const Eigen::JacobiSVD<Matrix6d> open(lost_directions(fit.information), Eigen::ComputeFullU);
    for (int i = 0; i < 6 && open.singularValues()[i] > kOpen; ++i) {
      const Vector6d direction = open.matrixU().col(i);
      const double turn = direction.tail<3>().norm();
      if (turn < kOpen) continue;
      for (const double turn_rad : {kOtherTurn_rad, kFarTurn_rad})
        if (excess(fit, direction * (turn_rad / turn)) > kOneSigma) return true;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turns(covariance.bottomRightCorner<3, 3>());
    for (int i = 0; i < 3; ++i) {
      const double sigma_rad = std::sqrt(std::max(turns.eigenvalues()[i], 1e-300));
      // The turn about this axis, and what goes with it.
      const Vector6d two_sigmas = covariance.rightCols<3>() * turns.eigenvectors().col(i) * (2.0 / sigma_rad);
      const double expected = 0.5 * two_sigmas.dot(fit.information * two_sigmas);
      const bool is_determined = std::abs(expected - 4.0 * kOneSigma) < 0.1;
      if (!is_determined || 2.0 * sigma_rad > kMostFrameTurn_rad) continue;
      if (excess(fit, two_sigmas) < kOneSigma || excess(fit, -two_sigmas) < kOneSigma) return true;
    }
    return false;
  }

  FrameFit from(const Eigen::Matrix3d& R_map_held) {
    FrameFit fit = at(Pose(R_map_held, usual_shift(R_map_held)));
    for (int i = 0; i < kMostFrameSteps; ++i) {
      Vector6d step = -blockwise_inverse(fit.information) * fit.gradient;
      const double turn = step.tail<3>().norm();
      if (turn > kMostFrameTurn_rad) step *= kMostFrameTurn_rad / turn;
      const double before = fit.cost;
      if (!improve(fit, step) || before - fit.cost < 1e-12 * (1.0 + before)) break;
    }
    return fit;
  }

 private:
  /// Of the cost, where the frame is moved.
  double excess(const FrameFit& fit, const Vector6d& step) {
    return at(fit.T_map_held * Pose::exp(step)).cost - fit.cost;
  }

  FrameFit at(const Pose& T_map_held) {
    state_.T_map_held = T_map_held;
    FrameFit fit{T_map_held, 0.0, Matrix6d::Zero(), Vector6d::Zero()};
    for (const BoundConstraint& bound : constraints_) {
      const LinearConstraint linear = linearise(bound, state_);
      const Eigen::VectorXd variances = variances_of(bound, linear);
      for (Eigen::Index row = 0; row < linear.residual.size(); ++row) {
        const double square = linear.residual[row] * linear.residual[row] / variances[row];
        const double weight = kFrameLoss.weight(square) / variances[row];
        const Vector6d derivative = linear.by_frame.row(row).transpose();
        fit.cost += kFrameLoss.cost(square);
        fit.information += weight * derivative * derivative.transpose();
        fit.gradient += weight * linear.residual[row] * derivative;
      }
    }
    return fit;
  }

  /// A direction that points the wrong way turns about with the least error of its tag: to first order that
  /// variance has no bound, but no turn of the tag changes the angle by more than itself.
  Eigen::VectorXd variances_of(const BoundConstraint& bound, const LinearConstraint& linear) const {
    Eigen::VectorXd variances = row_variances(bound, linear, prior_);
    const auto offset = prior_.offsets.find(bound.tags.front());
    const double turn_variance =
        offset == prior_.offsets.end()
            ? 0.0
            : prior_.covariance.block<3, 3>(offset->second + 3, offset->second + 3).trace();
    for (std::size_t i = 0; i < linear.rows.size(); ++i) {
      const ConstraintRow& row = linear.rows[i];
      double& variance = variances[static_cast<Eigen::Index>(i)];
      if (row.unit == std::string_view("rad"))
        variance = std::min(variance, 1.0 + turn_variance / (row.sigma * row.sigma));
    }
    return variances;
  }

  bool improve(FrameFit& fit, Vector6d step) {
    for (int i = 0; i < kMostHalvings; ++i, step *= 0.5) {
      FrameFit next = at(fit.T_map_held * Pose::exp(step));
      if (next.cost >= fit.cost) continue;
      fit = next;
      return true;
    }
    return false;
  }

  /// Along each axis the median shift that measured coordinates ask for.
  Eigen::Vector3d usual_shift(const Eigen::Matrix3d& R_map_held) const {
    std::array<std::vector<double>, 3> shifts;
    for (const BoundConstraint& bound : constraints_) {
      const Eigen::Vector3d centre =
          R_map_held * prior_.T_held_tag[static_cast<std::size_t>(bound.tags.front())].translation();
      if (const auto* position = std::get_if<PositionConstraint>(&bound.constraint->what)) {
        for (int axis = 0; axis < 3; ++axis) {
          const auto a = static_cast<std::size_t>(axis);
          if (position->position_m[a]) shifts[a].push_back(*position->position_m[a] - centre[axis]);
        }
      } else if (std::holds_alternative<FloorConstraint>(bound.constraint->what)) {
        shifts[2].push_back(-centre.z());
      }
    }
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double>& of_axis = shifts[static_cast<std::size_t>(axis)];
      if (of_axis.empty()) continue;
      std::ranges::sort(of_axis);
      shift[axis] = of_axis[of_axis.size() / 2];
    }
    return shift;
  }

  const ConstraintPrior& prior_;
  std::vector<BoundConstraint> constraints_;
  ConstraintState state_;
};

/// Whether `other` differs from `best` in what the constraints determine, and not only in what they leave
/// open (which keeps some axis or point of the map where it is: a group of motions); by more than they err.
bool is_another_frame(const FrameFit& best, const FrameFit& other) {
  const Eigen::JacobiSVD<Matrix6d> open(lost_directions(best.information), Eigen::ComputeFullU);
  const auto rank = (open.singularValues().array() > kOpen).count();
  const Eigen::MatrixXd basis = open.matrixU().leftCols(rank);
  const Vector6d difference = (best.T_map_held.inverse() * other.T_map_held).log();
  const Vector6d rest = difference - basis * (basis.transpose() * difference);
  const double turn_rad = rest.tail<3>().norm();
  return turn_rad > kOtherTurn_rad ||
         (turn_rad > kSameTurn_rad && rest.dot(best.information * rest) > kThreeSigmas2);
}

}  // namespace

MapFrameStart find_map_frame(std::span<const BoundConstraint> constraints, const ConstraintPrior& prior) {
  FrameSearch search(constraints, prior);
  if (search.is_empty()) return {};
  std::vector<FrameFit> fits;
  for (const Eigen::Matrix3d& R : cube_rotations()) fits.push_back(search.from(R));
  const FrameFit* best = &fits.front();
  for (const FrameFit& fit : fits) {
    if (fit.cost < best->cost - kSame) best = &fit;
  }
  const bool is_ambiguous = std::ranges::any_of(fits, [&](const FrameFit& fit) {
    return fit.cost < best->cost + kAboutAsGood && is_another_frame(*best, fit);
  });
  return {best->T_map_held, is_ambiguous || search.is_turn_misjudged(*best)};
}

CentresOfTags centres_of(std::span<const int> tags, const std::vector<Pose>& T_held_tag) {
  CentresOfTags centres;
  for (const int tag : tags)
    centres.mean +=
        T_held_tag[static_cast<std::size_t>(tag)].translation() / static_cast<double>(tags.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const int tag : tags) {
    const Eigen::Vector3d off = T_held_tag[static_cast<std::size_t>(tag)].translation() - centres.mean;
    spread += off * off.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  centres.line = axes.eigenvectors().col(2);
  centres.normal = axes.eigenvectors().col(0);
  centres.are_in_line = axes.eigenvalues()[1] < kInLine * kInLine * axes.eigenvalues()[2];
  return centres;
}

Pose plane_start(const BoundConstraint& group, const std::vector<Pose>& T_held_tag) {
  const CentresOfTags centres = centres_of(group.tags, T_held_tag);
  Eigen::Vector3d of_tags = Eigen::Vector3d::Zero();
  for (const int tag : group.tags)
    of_tags += T_held_tag[static_cast<std::size_t>(tag)].rotation() * Eigen::Vector3d::UnitZ();
  Eigen::Vector3d normal = centres.normal.dot(of_tags) < 0.0 ? -centres.normal : centres.normal;
  if (centres.are_in_line) normal = of_tags - centres.line.dot(of_tags) * centres.line;
  if (!(normal.norm() > 1e-6)) normal = centres.line.unitOrthogonal();  // back to back
  return {Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).normalized(), centres.mean};
}

}  // namespace apriltrack
