#include "start_fit.h"

#include <algorithm>

#include "path_bend.h"

namespace apriltrack {
namespace {

/// Whether what the corners weigh is about the same; they are the same corners.
bool is_noise_alike(const std::vector<CornerObservation>& a, const std::vector<CornerObservation>& b) {
  constexpr double kMaxRatio = 1.5;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double ratio = a[i].sigma_px / b[i].sigma_px;
    if (!(ratio < kMaxRatio && ratio > 1.0 / kMaxRatio)) return false;
  }
  return true;
}

/// As log_likelihood(), but that a tag which is like what is seen in its place as anything may be by chance
/// says nothing for the state: where a lone tag's tilt is open, some tilt always turns another tag's picture
/// to a shadow or an edge that fits it a little.
double score_of(const std::vector<TagEvidence>& tags) {
  constexpr double kByChance = 0.4, kNotByChance = 0.6;
  double sum = 0.0;
  for (const TagEvidence& tag : tags) {
    const double gain = tag.log_likelihood();
    const double share =
        std::clamp((tag.clean_correlation() - kByChance) / (kNotByChance - kByChance), 0.0, 1.0);
    sum += gain > 0.0 ? share * gain : gain;
  }
  return sum;
}

/// Since the frame before: no exposure is longer, whatever is told of it.
std::optional<double> time_to_bend_s(const BlurFrame& frame) {
  if (!frame.step_s) return std::nullopt;
  return std::max(*frame.step_s, frame.photometric.exposure_s);
}

}  // namespace

Explanation StartFit::explained(const BlurFrame& frame, const MotionStart& start,
                                const MotionFitOptions& options) const {
  Explanation explanation;
  explanation.fit = fitted(frame, start, options);
  explanation.prior = start.prior;
  explanation.is_cold = start.is_cold;
  explanation.sensitivity = frame.sensitivity;
  explanation.votes = votes(frame, explanation.fit.state);
  refit_without_tags_read_as_others(frame, explanation);
  if (world_.mode == TrackMode::kJoint) explanation.R_light_map = explanation.fit.state.pose.rotation();
  explanation.correlation = widespread_correlation(quorum(explanation.fit.tags, explanation.votes));
  explanation.prior_cost = prior_cost(start.prior.belief, explanation.fit.state);
  if (!start.is_cold)
    explanation.prior_spread = prior_spread(world_, start.prior.by_evidence(), explanation.fit);
  explanation.bend_covariance = bend_covariance_of(frame, explanation);
  explanation.score =
      score_of(explanation.fit.tags) + start.prior.log_odds - scored_prior_cost(explanation.prior_cost);
  return explanation;
}

Sketch StartFit::sketched(const BlurFrame& frame, MotionStart start, int coarsest_level) const {
  constexpr int kPixelsPerTag = 196;
  if (start.is_cold) start.state.acceleration.setZero();
  start.state = descend_motion(
      world_, frame.photometric, start.state, start.prior.belief,
      {.coarsest_level = coarsest_level, .finest_level = 1, .max_pixels_per_tag = kPixelsPerTag});
  const std::vector<TagEvidence> tags =
      weigh_evidence(world_, frame.photometric, start.state,
                     {.level = 1, .max_pixels_per_tag = kPixelsPerTag, .is_robust = false});
  const double of_prior = prior_cost(start.prior.belief, start.state);
  return {start, score_of(tags) + start.prior.log_odds - scored_prior_cost(of_prior)};
}

Matrix6d StartFit::bend_covariance_of(const BlurFrame& frame, const Explanation& explanation) const {
  std::optional<Vector6d> expected;
  if (!explanation.is_cold) expected = explanation.prior.expected_velocity();
  const PathBend bend =
      expected_bend(explanation.fit.state.velocity, expected, time_to_bend_s(frame), options_.motion_noise);
  return bend_covariance(bend.sigma, frame.photometric.exposure_s);
}

MotionFit StartFit::fitted(const BlurFrame& frame, const MotionStart& start, MotionFitOptions options) const {
  const auto bent_over_s = time_to_bend_s(frame);
  MotionState state = start.state;
  if (start.is_cold) state.acceleration.setZero();  // of a motion that it knows nothing of
  if (bent_over_s && !start.is_cold) {
    options.acceleration_per_change = acceleration_per_change(*bent_over_s);
    options.velocity_before = start.prior.expected_velocity();
  }
  const std::vector<CornerObservation> observed = corners(frame, state);
  MotionFit fit = fit_motion(world_, frame.photometric, state, start.prior.belief, observed, options);
  const std::vector<CornerObservation> as_found = corners(frame, fit.state);
  if (is_noise_alike(observed, as_found)) return fit;
  options.coarsest_level = 0;
  return fit_motion(world_, frame.photometric, fit.state, start.prior.belief, as_found, options);
}

void StartFit::refit_without_tags_read_as_others(const BlurFrame& frame, Explanation& explanation) const {
  std::vector<TagEvidence> tags = explanation.fit.tags;
  discredit_tags_read_as_others(world_, frame.detections, explanation.fit.state, explanation.votes, tags);
  std::vector<TagEvidence> discredited;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (tags[i].correlation < explanation.fit.tags[i].correlation) discredited.push_back(tags[i]);
  }
  if (discredited.empty()) return;
  for (const TagEvidence& tag : discredited) world_.tag_at(tag.tag_index).is_hidden = true;
  explanation.fit =
      fitted(frame, {explanation.fit.state, explanation.prior, explanation.is_cold}, {.coarsest_level = 0});
  explanation.votes = votes(frame, explanation.fit.state);
  for (const TagEvidence& tag : discredited) world_.tag_at(tag.tag_index).is_hidden = false;
  // That they are not seen speaks against the state all the same.
  for (const TagEvidence& tag : discredited) {
    explanation.fit.tags.push_back(tag);
    explanation.fit.equations.push_back({.evidence = tag});
  }
}

std::vector<CornerObservation> StartFit::corners(const BlurFrame& frame, const MotionState& state) const {
  return corner_observations(world_, frame.observations, state, frame.photometric.exposure_s,
                             options_.corner_sigma_px);
}

TagVotes StartFit::votes(const BlurFrame& frame, const MotionState& state) const {
  return count_votes(world_, frame.observations, state, frame.photometric.exposure_s,
                     options_.corner_sigma_px);
}

}  // namespace apriltrack
