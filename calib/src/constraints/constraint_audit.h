#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/calib/map_constraints.h"
#include "constraints/constrained_fit.h"

namespace apriltrack {

/// A constraint against all else: what the others and the images predict of it.
struct Prediction {
  Eigen::VectorXd error;      ///< Predicted less measured, in sigmas of what was measured.
  Eigen::VectorXd sigma;      ///< Of it, in the same; infinite where nothing predicts the number.
  double z = 0.0;             ///< As ConstraintAudit::z.
  bool is_predicted = false;  ///< Anything of it.
};

/// Of the constraint at `place` of the fit: exactly what a fit without it would say, to first order.
Prediction predict(const ConstrainedFit& fit, std::size_t place);

/// What is left when constraints that contradict all else are taken away one by one, the worst first
/// (W. Baarda's data snooping). After kMostGross it is given up: then all are wrong alike, each takes a fit,
/// and nobody reads more.
struct ConstraintJudgement {
  ConstrainedFit fit;  ///< Of `kept`.
  std::vector<BoundConstraint> kept;
  std::vector<ConstraintAudit> audits;      ///< Of kept and gross ones, in the order they were given.
  std::vector<std::string> contradictions;  ///< Of gross ones, in words.
  /// Where it was given up: how many contradict all else, taken away or not.
  std::optional<std::size_t> num_contradicting;
  std::vector<std::string> doubts;  ///< 3 to 5 sigmas, in words.
};

inline constexpr double kDoubtful = 3.0;  // sigmas
inline constexpr double kContradictory = 5.0;
inline constexpr std::size_t kMostGross = 20;

/// start: frame and planes.
ConstraintJudgement judge_constraints(const std::vector<BoundConstraint>& constraints,
                                      const ConstraintPrior& prior, const ConstraintState& start);

/// In words, where distances all differ from what the map says by one ratio; else empty.
std::string common_ratio_hint(const std::vector<BoundConstraint>& constraints, const ConstraintPrior& prior);

}  // namespace apriltrack
