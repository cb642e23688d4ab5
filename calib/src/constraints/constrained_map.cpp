#include "constraints/constrained_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/calib/map_constraints.h"
#include "constraints/map_frame_start.h"
#include "constraints/measured_frame.h"
#include "constraints/unit_of_lengths.h"
#include "numerics/words.h"

namespace apriltrack {
namespace {

using IndexedAudits = std::vector<std::pair<std::size_t, ConstraintAudit>>;

ConstraintPrior prior_of(const std::vector<BoundConstraint>& constraints, const ImageMap& map,
                         const CovarianceOperator& joint) {
  ConstraintPrior prior;
  prior.T_held_tag = map.T_held_tag;
  std::set<int> tags;
  for (const BoundConstraint& bound : constraints) tags.insert(bound.tags.begin(), bound.tags.end());
  tags.erase(map.held_tag);
  for (const int tag : tags) prior.offsets[tag] = 6 * static_cast<Eigen::Index>(prior.offsets.size());
  const auto size = 6 * static_cast<Eigen::Index>(prior.offsets.size());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(joint.size(), size);
  for (const auto& [tag, offset] : prior.offsets)
    columns.block<6, 6>(*joint.offset_of(tag), offset).setIdentity();
  columns = joint.times(columns);
  prior.covariance.resize(size, size);
  for (const auto& [tag, offset] : prior.offsets)
    prior.covariance.middleRows<6>(offset) = columns.middleRows<6>(*joint.offset_of(tag));
  prior.covariance = (0.5 * (prior.covariance + prior.covariance.transpose())).eval();
  return prior;
}

/// The covariance of all poses with the rows of the fit: cov A'.
Eigen::MatrixXd covariance_with_rows(const ConstrainedFit& fit, const ConstraintPrior& prior,
                                     const CovarianceOperator& joint) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(joint.size(), fit.by_tags.rows());
  for (const auto& [tag, offset] : prior.offsets)
    columns.middleRows<6>(*joint.offset_of(tag)) =
        Eigen::MatrixXd(fit.by_tags.middleCols(offset, 6)).transpose();
  return joint.times(columns);
}

/// Of a symmetric positive semidefinite matrix.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& matrix) {
  const Eigen::LDLT<Eigen::MatrixXd> factor(matrix);
  const Eigen::MatrixXd lower = factor.matrixL();
  return factor.transpositionsP().transpose() *
         (lower * factor.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal()).eval();
}

/// The rows of the fit with columns as in `result`.
Eigen::SparseMatrix<double> spread_columns(const ConstrainedFit& fit, const ConstraintPrior& prior,
                                           const std::vector<int>& tags) {
  std::map<Eigen::Index, Eigen::Index> place;  // of a tag's columns in the fit
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto offset = prior.offsets.find(tags[i]);
    if (offset != prior.offsets.end()) place[offset->second] = 6 * static_cast<Eigen::Index>(i);
  }
  std::vector<Eigen::Triplet<double, Eigen::Index>> entries;
  for (Eigen::Index column = 0; column < fit.by_tags.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(fit.by_tags, column); entry; ++entry)
      entries.emplace_back(entry.row(), place.at(column - column % 6) + column % 6, entry.value());
  }
  Eigen::SparseMatrix<double> result(fit.by_tags.rows(), 6 * static_cast<Eigen::Index>(tags.size()));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Poses and covariances of all tags, those that no constraint names as well.
void take_fit(const ConstrainedFit& fit, const ConstraintPrior& prior, const ImageMap& map,
              const CovarianceOperator& joint, ConstrainedMap& result) {
  const Eigen::MatrixXd with_rows = covariance_with_rows(fit, prior, joint);
  const Eigen::MatrixXd lost_root = with_rows * square_root(fit.precision);
  const Eigen::Index num_rows = 6 * static_cast<Eigen::Index>(map.tags.size());
  JointChange& change = result.change;
  change.lost_root = change.with_rows = Eigen::MatrixXd::Zero(num_rows, lost_root.cols());
  change.by_tags = spread_columns(fit, prior, map.tags);
  change.precision = fit.precision;
  if (fit.has_frame) change.frame_push = fit.frame_coupling;
  change.by_frame = change.with_frame = Eigen::MatrixXd::Zero(num_rows, 6);
  change.frame_covariance = fit.frame_covariance;
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    const auto t = static_cast<std::size_t>(map.tags[i]);
    Pose T_held_tag = map.T_held_tag[t];
    Matrix6d covariance = map.covariances[i];
    Matrix6d with_frame = Matrix6d::Zero();
    if (const auto offset = joint.offset_of(map.tags[i])) {
      const auto own = with_rows.middleRows<6>(*offset);
      T_held_tag = T_held_tag * Pose::exp(Vector6d(-(own * fit.push)));
      const auto lost = lost_root.middleRows<6>(*offset);
      change.lost_root.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = lost;
      change.with_rows.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = own;
      covariance -= lost * lost.transpose();
      if (fit.has_frame) with_frame = -own * fit.frame_coupling;
    }
    if (fit.has_frame) {
      const Matrix6d by_frame = T_held_tag.inverse().adjoint();
      covariance += by_frame * fit.frame_covariance * by_frame.transpose() +
                    by_frame * with_frame.transpose() + with_frame * by_frame.transpose();
      change.by_frame.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = by_frame;
      change.with_frame.middleRows<6>(6 * static_cast<Eigen::Index>(i)) = with_frame;
    }
    result.T_map_tag[t] = fit.state.T_map_held * T_held_tag;
    result.covariances.push_back(0.5 * (covariance + covariance.transpose()));
  }
  result.T_map_held = fit.state.T_map_held;
}

/// count: of all constraints that were weighed.
std::string contradictions_in_words(const ConstraintJudgement& judgement, std::size_t count,
                                    const std::string& hint, const std::vector<std::string>& doubts) {
  const std::string many = judgement.num_contradicting
                               ? fmt::format("{} of {} contradict: is the unit metres (and rad)? ",
                                             *judgement.num_contradicting, count)
                               : "";
  return fmt::format(
      "constraints contradict the images or each other: {}{}. {}{}Correct them, or take them out of the "
      "file; no map was made{}{}",
      many, join_first(judgement.contradictions, "; ", 5), hint, hint.empty() ? "" : " ",
      doubts.empty() ? "" : ". Of the map itself this is in doubt, and may be why: ",
      fmt::join(doubts, ". "));
}

/// A matrix of their number squared is inverted.
void require_few_rows(const std::vector<BoundConstraint>& constraints) {
  constexpr Eigen::Index kMostRows = 6000;
  Eigen::Index rows = 0;
  for (const BoundConstraint& bound : constraints) rows += num_rows(*bound.constraint);
  if (rows > kMostRows)
    throw invalid_input("constraints",
                        fmt::format("tell {} numbers, and {} is the most: leave some out", rows, kMostRows));
}

ConstraintAudit unused_audit(const MapConstraint& constraint, std::string reason) {
  ConstraintAudit audit;
  audit.title = title_of(constraint);
  audit.type = type_of(constraint);
  audit.tags = tags_of(constraint);
  audit.reason = std::move(reason);
  return audit;
}

std::vector<ConstraintAudit> in_given_order(std::vector<ConstraintAudit> used,
                                            const std::vector<BoundConstraint>& bound, IndexedAudits unused) {
  for (std::size_t i = 0; i < used.size(); ++i) unused.emplace_back(bound[i].index, std::move(used[i]));
  std::ranges::sort(unused, {}, [](const auto& one) { return one.first; });
  std::vector<ConstraintAudit> audits;
  for (auto& [index, audit] : unused) audits.push_back(std::move(audit));
  return audits;
}

/// Before any is weighed: those would all be taken away, with a fit for each.
void require_metres(const std::vector<BoundConstraint>& bound, const ConstraintPrior& prior,
                    IndexedAudits& unused) {
  const auto other = find_other_unit(bound, prior);
  if (!other) return;
  std::vector<ConstraintAudit> audits;
  for (const BoundConstraint& one : bound) {
    const bool is_off = std::ranges::count(other->constraints, one.constraint) > 0;
    audits.push_back(
        unused_audit(*one.constraint, is_off ? "its length is in no metres" : "was not weighed"));
  }
  throw ConstraintError(other->words, in_given_order(std::move(audits), bound, std::move(unused)));
}

}  // namespace

std::vector<BoundConstraint> bind_constraints(std::span<const MapConstraint> constraints, const ImageMap& map,
                                              IndexedAudits& unused) {
  std::vector<BoundConstraint> bound;
  int planes = 0;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    BoundConstraint one{&constraints[i], i, {}, -1};
    std::vector<std::string> missing;
    if (std::holds_alternative<CameraGravityConstraint>(constraints[i].what))
      missing.emplace_back("a frame of that time");
    for (const TagKey& key : tags_of(constraints[i])) {
      const auto tag =
          std::ranges::find_if(map.tags, [&](int t) { return map.keys[static_cast<std::size_t>(t)] == key; });
      if (tag == map.tags.end()) {
        missing.push_back(to_string(key));
      } else {
        one.tags.push_back(*tag);
      }
    }
    const auto* coplanar = std::get_if<CoplanarConstraint>(&constraints[i].what);
    const bool has_no_plane = missing.empty() && coplanar != nullptr && !coplanar->sigma_rad &&
                              centres_of(one.tags, map.T_held_tag).are_in_line;
    if (missing.empty() && !has_no_plane) {
      if (coplanar != nullptr) one.plane = planes++;
      bound.push_back(std::move(one));
      continue;
    }
    unused.emplace_back(
        i, unused_audit(constraints[i],
                        has_no_plane ? "its tags lie in a line, through which many planes go: give sigma_rad"
                                     : fmt::format("not in the map: {}", fmt::join(missing, ", "))));
  }
  return bound;
}

ConstrainedMap constrain_map(std::span<const MapConstraint> constraints, const ImageMap& map,
                             const CovarianceOperator& joint) {
  ConstrainedMap result;
  result.T_map_tag = map.T_held_tag;
  IndexedAudits unused;
  const std::vector<BoundConstraint> bound = bind_constraints(constraints, map, unused);
  for (const auto& [index, audit] : unused)
    result.notes.unused.push_back(fmt::format("constraint '{}' is not used: {}", audit.title, audit.reason));
  const auto tells_frame = [](const BoundConstraint& one) { return is_of_frame(*one.constraint); };
  if (std::ranges::any_of(constraints, is_of_frame) && std::ranges::none_of(bound, tells_frame))
    result.notes.not_measured.push_back(
        fmt::format("the map is NOT in the measured frame, for none of the constraints that tell it is used: "
                    "{} is at the origin",
                    to_string(map.keys[static_cast<std::size_t>(map.held_tag)])));
  if (bound.empty()) {
    result.covariances = map.covariances;
    result.audits = in_given_order({}, {}, std::move(unused));
    return result;
  }
  require_few_rows(bound);
  const ConstraintPrior prior = prior_of(bound, map, joint);
  require_metres(bound, prior, unused);
  const MapFrameStart frame = find_map_frame(bound, prior);
  ConstraintState start{map.T_held_tag, frame.T_map_held, {}};
  for (const BoundConstraint& one : bound) {
    if (one.plane >= 0) start.T_held_plane.push_back(plane_start(one, map.T_held_tag));
  }
  ConstraintJudgement judgement = judge_constraints(bound, prior, start);
  const std::string hint = common_ratio_hint(bound, prior);
  const auto fail = [&](const std::string& why) {
    throw ConstraintError(why, in_given_order(std::move(judgement.audits), bound, std::move(unused)));
  };
  if (!judgement.contradictions.empty())
    fail(contradictions_in_words(judgement, bound.size(), hint, map.doubts));
  if (frame.is_ambiguous)
    fail(
        "two map frames that are turned against each other agree with the constraints equally well (heights "
        "of tags in one upright plane do not tell its tilt, those of three tags not which side is up): add "
        "one that tells them apart, such as gravity, upright, or a third coordinate");
  if (!judgement.fit.has_settled)
    fail(
        "the map does not settle with the constraints, which tell its frame, or a plane, hardly at all: add "
        "one that tells it, such as gravity or upright, or take out the loosest ones");
  take_fit(judgement.fit, prior, map, joint, result);
  constexpr std::size_t kMostDoubts = 10;
  for (std::size_t i = 0; i < std::min(kMostDoubts, judgement.doubts.size()); ++i)
    result.notes.in_doubt.push_back("constraint in doubt: " + judgement.doubts[i]);
  if (judgement.doubts.size() > kMostDoubts)
    result.notes.in_doubt.push_back(
        fmt::format("and {} more constraints in doubt", judgement.doubts.size() - kMostDoubts));
  if (!judgement.doubts.empty() && !hint.empty()) result.notes.in_doubt.push_back(hint);
  result.is_vertical_measured = is_vertical_measured(judgement.fit);
  result.gauge = gauge_in_words(judgement.fit, bound, map.keys[static_cast<std::size_t>(map.held_tag)]);
  result.audits = in_given_order(std::move(judgement.audits), bound, std::move(unused));
  return result;
}

}  // namespace apriltrack
