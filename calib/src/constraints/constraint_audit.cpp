#include "constraints/constraint_audit.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apriltrack/base/degrees.h"
#include "apriltrack/calib/map_constraints.h"
#include "numerics/words.h"

namespace apriltrack {
namespace {

constexpr double kUnpredicted = 1e-9;  // of the precision: sigmas over 3e4 times those of what was measured
constexpr double kAsLikely = 0.8;      // of the worst z: either may be wrong

/// Wilson and Hilferty: chi squared of n degrees of freedom as sigmas.
double equivalent_sigmas(double chi2, int n) {
  if (n == 1) return std::sqrt(chi2);
  const double spread = 2.0 / (9.0 * n);
  return std::max(0.0, (std::cbrt(chi2 / n) - (1.0 - spread)) / std::sqrt(spread));
}

ConstraintAudit audit_of(const BoundConstraint& bound, const LinearConstraint& linear,
                         const Prediction& prediction) {
  ConstraintAudit audit;
  audit.title = title_of(*bound.constraint);
  audit.type = type_of(*bound.constraint);
  audit.tags = tags_of(*bound.constraint);
  audit.is_used = true;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const ConstraintRow& row = linear.rows[i];
    const auto r = static_cast<Eigen::Index>(i);
    ConstraintReading reading{row.name, row.unit, row.measured, std::nullopt, std::nullopt};
    if (std::isfinite(prediction.sigma[r])) {
      reading.predicted = row.measured + prediction.error[r] * row.sigma;
      reading.sigma = prediction.sigma[r] * row.sigma;
    }
    audit.readings.push_back(std::move(reading));
  }
  if (prediction.is_predicted) audit.z = prediction.z;
  return audit;
}

/// With so many decimals, or two digits where these would show none.
std::string told_sigma(double sigma, int decimals) {
  return sigma < std::pow(10.0, -decimals) ? fmt::format("{:.2g}", sigma)
                                           : fmt::format("{:.{}f}", sigma, decimals);
}

/// "distance: 0.512 m measured, all else says 0.4871 (sigma 0.6 mm)", of the number that is off most.
std::string worst_reading(const ConstraintAudit& audit) {
  const auto worst = std::ranges::max_element(audit.readings, {}, &ConstraintReading::sigmas_off);
  if (worst == audit.readings.end() || !worst->sigma) return "";
  if (worst->unit == "rad")
    return fmt::format("{}: {:.2f} degrees off what all else says (sigma {})", worst->name,
                       kDegPerRad * std::abs(*worst->predicted - worst->measured),
                       told_sigma(kDegPerRad * *worst->sigma, 2));
  const auto [measured, predicted] = told_apart(worst->measured, *worst->predicted, 4);
  return fmt::format("{}: {} m measured, all else says {} m (sigma {} mm)", worst->name, measured, predicted,
                     told_sigma(1e3 * *worst->sigma, 1));
}

std::string audit_in_words(const BoundConstraint& bound, const ConstraintAudit& audit) {
  const std::string worst = worst_reading(audit);
  return fmt::format("{}{}: {}: {:.1f} sigmas off",
                     bound.constraint->where.empty() ? "" : bound.constraint->where + ": ", audit.title,
                     worst.empty() ? "its numbers together" : worst, audit.z.value_or(0.0));
}

struct Worst {
  std::size_t place = 0;
  double z = 0.0;
};

Worst worst_of(const ConstrainedFit& fit) {
  Worst worst;
  for (std::size_t i = 0; i < fit.constraints.size(); ++i) {
    const Prediction prediction = predict(fit, i);
    if (prediction.is_predicted && !(prediction.z <= worst.z)) worst = {i, prediction.z};
  }
  return worst;
}

/// Titles of others that are about as far off.
std::string rivals_of(const ConstrainedFit& fit, const std::vector<BoundConstraint>& constraints,
                      const Worst& worst) {
  std::vector<std::string> titles;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    if (i == worst.place || predict(fit, i).z < kAsLikely * worst.z) continue;
    titles.push_back(title_of(*constraints[i].constraint));
  }
  return join_first(titles, ", ", 5);
}

/// What the fit says of a constraint that is not in it.
ConstraintAudit audit_from_outside(const BoundConstraint& bound, const ConstraintJudgement& judgement,
                                   const ConstraintPrior& prior) {
  std::vector<BoundConstraint> all = judgement.kept;
  all.push_back(bound);
  const ConstrainedFit with = look_at_constraints(all, prior, judgement.fit.state);
  ConstraintAudit audit = audit_of(bound, with.constraints.back(), predict(with, all.size() - 1));
  audit.is_used = false;
  audit.reason = "contradicts all else";
  return audit;
}

/// Constraints that foretell each other are no test of the images: all of them together are one.
double sigmas_together(const ConstrainedFit& fit) {
  const auto frame = fit.has_frame ? 6 - fit.open_directions.cols() : 0;
  const auto planes = kPlaneUnknowns * static_cast<Eigen::Index>(fit.state.T_held_plane.size());
  const Eigen::Index freedom = fit.disagreement.size() - frame - planes;
  if (freedom <= 0) return 0.0;
  return equivalent_sigmas(fit.disagreement.dot(fit.push), static_cast<int>(freedom));
}

/// Of all of them the one that the fit pays most for.
std::string costliest(const ConstrainedFit& fit, const std::vector<BoundConstraint>& constraints) {
  const Eigen::VectorXd costs = fit.disagreement.cwiseProduct(fit.push);
  std::size_t worst = 0;
  double most = 0.0;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const double cost = costs.segment(fit.first_rows[i], fit.constraints[i].residual.size()).sum();
    if (cost <= most) continue;
    most = cost;
    worst = i;
  }
  const MapConstraint& constraint = *constraints[worst].constraint;
  return (constraint.where.empty() ? "" : constraint.where + ": ") + title_of(constraint);
}

void judge_together(const std::vector<BoundConstraint>& kept, ConstraintJudgement& judgement) {
  const double sigmas = kept.empty() ? 0.0 : sigmas_together(judgement.fit);
  if (sigmas <= kDoubtful) return;
  const std::string words = fmt::format(
      "the constraints agree with each other, but all together they are {:.1f} sigmas off what the images "
      "say, most of all {}: look for an error that all of them share, a wrong tag size, or a camera file "
      "that does not fit",
      sigmas, costliest(judgement.fit, kept));
  (sigmas > kContradictory ? judgement.contradictions : judgement.doubts).push_back(words);
}

struct GrossConstraint {
  BoundConstraint bound;
  std::string rivals;  // what may be wrong in its place
};

std::size_t count_contradicting(const ConstrainedFit& fit) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < fit.constraints.size(); ++i) {
    const Prediction prediction = predict(fit, i);
    count += prediction.is_predicted && prediction.z > kContradictory;
  }
  return count;
}

/// From kept to the result. Each fit goes on from the one before; a wrong constraint may have led that to a
/// frame from which there is no way back, so the last word has a fit from `start`.
std::vector<GrossConstraint> take_gross_away(const ConstraintPrior& prior, const ConstraintState& start,
                                             ConstraintJudgement& judgement) {
  std::vector<GrossConstraint> gross;
  bool is_from_start = true;
  judgement.fit = fit_constraints(judgement.kept, prior, start);
  while (!judgement.kept.empty()) {
    const Worst worst = worst_of(judgement.fit);
    const bool is_clean = worst.z <= kContradictory;
    if (is_clean && is_from_start) break;
    if (!is_clean && gross.size() == kMostGross) {
      judgement.num_contradicting = gross.size() + count_contradicting(judgement.fit);
      break;
    }
    if (!is_clean) {
      gross.push_back({judgement.kept[worst.place], rivals_of(judgement.fit, judgement.kept, worst)});
      judgement.kept.erase(judgement.kept.begin() + static_cast<std::ptrdiff_t>(worst.place));
    }
    is_from_start = is_clean || judgement.kept.empty() || !judgement.fit.push.allFinite();
    judgement.fit = fit_constraints(judgement.kept, prior, is_from_start ? start : judgement.fit.state);
  }
  return gross;
}

}  // namespace

Prediction predict(const ConstrainedFit& fit, std::size_t place) {
  const Eigen::Index first = fit.first_rows[place], rows = fit.constraints[place].residual.size();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(fit.precision.block(first, first, rows, rows));
  const Eigen::VectorXd pushed = fit.push.segment(first, rows);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(rows, rows), range = covariance;
  int rank = 0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (!(solver.eigenvalues()[i] > kUnpredicted)) continue;
    const Eigen::VectorXd axis = solver.eigenvectors().col(i);
    covariance += axis * axis.transpose() / solver.eigenvalues()[i];
    range += axis * axis.transpose();
    ++rank;
  }
  Prediction prediction;
  prediction.error = covariance * pushed;
  prediction.sigma = Eigen::VectorXd::Constant(rows, std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < rows; ++i) {
    if (range(i, i) > 1.0 - 1e-6) prediction.sigma[i] = std::sqrt(covariance(i, i));
  }
  prediction.is_predicted = rank > 0;
  if (rank > 0) prediction.z = equivalent_sigmas(pushed.dot(prediction.error), rank);
  return prediction;
}

ConstraintJudgement judge_constraints(const std::vector<BoundConstraint>& constraints,
                                      const ConstraintPrior& prior, const ConstraintState& start) {
  ConstraintJudgement judgement;
  judgement.kept = constraints;
  const std::vector<GrossConstraint> gross = take_gross_away(prior, start, judgement);
  if (gross.empty()) judge_together(judgement.kept, judgement);
  std::vector<std::pair<std::size_t, ConstraintAudit>> audits;
  for (std::size_t i = 0; i < judgement.kept.size(); ++i) {
    const BoundConstraint& bound = judgement.kept[i];
    audits.emplace_back(bound.index,
                        audit_of(bound, judgement.fit.constraints[i], predict(judgement.fit, i)));
    if (audits.back().second.z.value_or(0.0) > kDoubtful)
      judgement.doubts.push_back(audit_in_words(bound, audits.back().second));
  }
  for (const auto& [bound, rivals] : gross) {
    ConstraintAudit audit = audit_from_outside(bound, judgement, prior);
    judgement.contradictions.push_back(audit_in_words(bound, audit) +
                                       (rivals.empty() ? "" : " (or wrong in its place: " + rivals + ")"));
    audits.emplace_back(bound.index, std::move(audit));
  }
  std::ranges::sort(audits, {}, [](const auto& one) { return one.first; });
  for (auto& [index, audit] : audits) judgement.audits.push_back(std::move(audit));
  return judgement;
}

std::string common_ratio_hint(const std::vector<BoundConstraint>& constraints, const ConstraintPrior& prior) {
  struct Ratio {
    double value = 0.0, weight = 0.0;  // measured over mapped; 1 / variance
  };
  std::vector<Ratio> ratios;
  double sum = 0.0, weights = 0.0;
  const ConstraintState state{prior.T_held_tag, {}, {}};
  for (const BoundConstraint& bound : constraints) {
    const auto* distance = std::get_if<DistanceConstraint>(&bound.constraint->what);
    if (distance == nullptr) continue;
    const LinearConstraint linear = linearise(bound, state);
    const double mapped_m = distance->distance_m + linear.residual[0] * distance->sigma_m;
    if (!(mapped_m > 0.0)) continue;
    const double sigma_m = distance->sigma_m * std::sqrt(row_variances(bound, linear, prior)[0]);
    const Ratio ratio{distance->distance_m / mapped_m, mapped_m * mapped_m / (sigma_m * sigma_m)};
    ratios.push_back(ratio);
    sum += ratio.weight * ratio.value;
    weights += ratio.weight;
  }
  if (ratios.empty()) return "";
  const double mean = sum / weights;
  double squares = 0.0;
  for (const Ratio& ratio : ratios) squares += ratio.weight * (ratio.value - mean) * (ratio.value - mean);
  const int others = static_cast<int>(ratios.size()) - 1;
  const bool is_common = others == 0 || equivalent_sigmas(squares, others) < kDoubtful;
  if (!is_common || std::abs(mean - 1.0) * std::sqrt(weights) < kDoubtful) return "";
  return fmt::format(
      "{} {:.2f} % {} than in the map: a wrong tag size makes that of all of them; are the tags' edges "
      "{:.4f} times as long as stated?",
      others == 0 ? "The distance is" : fmt::format("All {} distances are", ratios.size()),
      100.0 * std::abs(mean - 1.0), mean > 1.0 ? "longer" : "shorter", mean);
}

}  // namespace apriltrack
