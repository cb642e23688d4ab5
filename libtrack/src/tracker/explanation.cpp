#include "explanation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "place_spread.h"

namespace apriltrack {
namespace {

/// Explained well enough to look no further: what a right state reaches where nothing hides the tags.
constexpr double kGoodCorrelation = 0.94;
/// Of a cold start more is asked: it begins at rest, and where it is not, a slow path is a good second best.
constexpr double kGoodColdCorrelation = 0.97;

}  // namespace

double prior_cost(const MotionBelief& prior, const MotionState& state) {
  const double sigmas = distance(prior, state);
  return 0.5 * sigmas * sigmas;
}

double prior_spread(const PhotometricWorld& world, const MotionBelief& prior, const MotionFit& fit) {
  double least = std::numeric_limits<double>::infinity();
  for (const TagEvidence& evidence : explained_tags(fit.tags)) {
    const PhotometricTag& tag = world.tag_at(evidence.tag_index);
    const double sigma_px =
        place_sigma_px(world, tag, fit.state.pose, prior.covariance.topLeftCorner<6, 6>());
    if (sigma_px > 0.0) least = std::min(least, sigma_px / tag_size_px(world, tag, fit.state.pose));
  }
  return least;
}

bool is_missed(const TagEvidence& tag) {
  constexpr double kLeastSamples = 100.0;
  return !tag.is_explained() && tag.independent_samples() >= kLeastSamples;
}

bool is_where_seen(const Explanation& explanation) {
  return explanation.prior.agrees_with_turn && explanation.prior_cost <= kMaxExpectedPriorCost;
}

bool surprises_alone(const Explanation& explanation) {
  return !explanation.is_cold && explanation.votes.agreeing.empty() &&
         explanation.prior_cost > kMaxLonePriorCost && explained_tags(explanation.fit.tags).size() == 1;
}

bool rests_on_part_of_a_tag(const Explanation& explanation) {
  const std::vector<TagEvidence> tags = explained_tags(explanation.fit.tags);
  return tags.size() == 1 && tags.front().clean_correlation() < kGoodCorrelation;
}

bool is_well_explained(const Explanation& explanation) {
  // A lone tag that was read may be tilted far off, with the others in view nowhere near.
  if (typical_correlation(explanation.fit.tags) < TagEvidence::kExplained) return false;
  if (!explanation.is_cold)
    return is_where_seen(explanation) ? explanation.is_explained()
                                      : explanation.correlation >= kGoodCorrelation;
  return widespread_correlation(explanation.fit.tags) >= kGoodColdCorrelation &&
         explanation.prior_cost <= kMaxExpectedPriorCost;
}

double longest_path_px(const Explanation& explanation) {
  double longest_px = 0.0;
  for (const TagEvidence& tag : explanation.fit.tags) longest_px = std::max(longest_px, tag.path_px);
  return longest_px;
}

Explanation path_reversed(const Explanation& best) {
  const Matrix12d prior = best.prior.belief.covariance.ldlt().solve(Matrix12d::Identity());
  Vector12d sign = Vector12d::Ones();
  sign.tail<6>().setConstant(-1.0);
  const Matrix12d data = sign.asDiagonal() * (best.fit.information - prior) * sign.asDiagonal();
  const Vector12d data_gradient =  // where the fit ended, that of the prior balances it
      -(sign.asDiagonal() * (prior * difference(best.prior.belief.mean, best.fit.state)));
  Explanation reversed = best;
  MotionState& state = reversed.fit.state;
  state.velocity = -state.velocity;
  const Vector12d pull = prior * difference(best.prior.belief.mean, state);
  reversed.fit.information = data + prior;
  const Vector12d step = -reversed.fit.information.ldlt().solve(data_gradient + pull);
  state = moved(state, step);
  for (TagEquations& tag : reversed.fit.equations) {
    tag.H = sign.asDiagonal() * tag.H * sign.asDiagonal();
    tag.g = sign.asDiagonal() * tag.g;
  }
  const double data_cost = data_gradient.dot(step) + 0.5 * step.dot(data * step);
  const double cost = prior_cost(best.prior.belief, state);
  reversed.score += scored_prior_cost(best.prior_cost) - scored_prior_cost(cost) - data_cost;
  reversed.prior_cost = cost;
  return reversed;
}

bool is_better(const Explanation& a, const Explanation& b) {
  if (a.is_beyond_prior() != b.is_beyond_prior()) return b.is_beyond_prior();
  return a.score > b.score;
}

void sort_by_score(std::vector<Explanation>& found) {
  std::ranges::stable_sort(found, is_better);
}

}  // namespace apriltrack
