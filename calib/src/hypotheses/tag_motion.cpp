// A tag that does not stay at its place.

#include <algorithm>
#include <cmath>
#include <utility>

#include "hypotheses/tag_hypotheses.h"

namespace apriltrack {
namespace {

// How far (one standard deviation) a tag is moved, and how far one swings that hangs loosely; and in how many
// tags that is so.
constexpr double kShift_m = 0.2, kTurn_rad = 0.3, kSwing_m = 0.012, kSwing_rad = 0.08, kShareMoving = 0.02;
// Time is cut into so many stretches, of three views or more; a tag may move between two of them.
constexpr std::size_t kMostStretches = 16, kLeastViewsOfStretch = 3;

std::size_t num_stretches(const TagViews& tag) {
  return std::min(kMostStretches, tag.views.size() / kLeastViewsOfStretch);
}

std::size_t stretch_of(const TagViews& tag, std::size_t view) {
  return view * num_stretches(tag) / tag.views.size();
}

Eigen::VectorXd sigmas_of_poses(double shift_m, double turn_rad, std::size_t num) {
  Vector6d one;
  one << Eigen::Vector3d::Constant(shift_m), Eigen::Vector3d::Constant(turn_rad);
  return one.replicate(static_cast<Eigen::Index>(num), 1);
}

/// One place up to the stretch, another from it on: a share of the columns of all stretches.
Eigen::MatrixXd from_stretch_on(std::size_t first, std::size_t stretches) {
  Eigen::MatrixXd later = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * stretches), 6);
  for (std::size_t i = first; i < stretches; ++i)
    later.middleRows<6>(static_cast<Eigen::Index>(6 * i)).setIdentity();
  return later;
}

TagHypothesis moved_once(const TagViews& tag, const Score& score) {
  const NullScale scale = tag.scale.times(tag.scale.lasting);
  const std::size_t stretches = num_stretches(tag);
  TagHypothesis best{.kind = TagFinding::Kind::kMoved};
  std::vector<double> log_odds;
  std::size_t moment = 0;
  for (std::size_t first = 1; first < stretches; ++first) {
    Evidence evidence = evidence_of(score.combined(from_stretch_on(first, stretches)), scale,
                                    sigmas_of_poses(kShift_m, kTurn_rad, 1), std::log(kShareMoving));
    log_odds.push_back(evidence.log_odds);
    if (moment != 0 && evidence.log_odds <= best.evidence.log_odds) continue;
    best.evidence = std::move(evidence);
    moment = first;
  }
  for (std::size_t i = 0; i < tag.views.size(); ++i)
    best.is_at_second.push_back(stretch_of(tag, i) >= moment);
  // When it moved is not known: all moments are alike before.
  best.evidence.log_odds = log_sum_exp(log_odds) - std::log(static_cast<double>(log_odds.size()));
  return best;
}

TagHypothesis hangs_loosely(const TagViews& tag, const Score& score) {
  return {.kind = TagFinding::Kind::kLoose,
          .evidence = evidence_of(score, tag.scale, sigmas_of_poses(kSwing_m, kSwing_rad, num_stretches(tag)),
                                  std::log(kShareMoving))};
}

}  // namespace

std::optional<Score> score_of_motion(const TagViews& tag) {
  if (num_stretches(tag) < 2) return std::nullopt;
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < tag.views.size(); ++i)
    columns.push_back({tag.views[i], tag.map.views[tag.views[i]].by_tag,
                       static_cast<Eigen::Index>(6 * stretch_of(tag, i))});
  return tag.score(columns);
}

double mean_square_of_moves(const Score& score, const ErrorScale& scale) {
  const auto stretches = static_cast<std::size_t>(score.gradient.size()) / 6;
  double sum = 0.0;
  for (std::size_t first = 1; first < stretches; ++first)
    sum += score.combined(from_stretch_on(first, stretches)).mean_square(scale);
  return sum / static_cast<double>(stretches - 1);
}

std::vector<TagHypothesis> faults_of_motion(const TagViews& tag) {
  const auto score = score_of_motion(tag);
  if (!score) return {};
  return {moved_once(tag, *score), hangs_loosely(tag, *score)};
}

}  // namespace apriltrack
