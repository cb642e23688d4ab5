#include "blur_explanation.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

#include "blur_cloud.h"
#include "blur_corners.h"
#include "motion_start.h"
#include "path_bend.h"
#include "pose_adjustment.h"

namespace apriltrack {
namespace {

/// Explained so badly that a second, larger cloud may find what the first missed; later after the last
/// evidence than this the prior is too wide for any.
constexpr double kPoorCorrelation = 0.85;
constexpr double kMaxSecondCloudAge_s = 0.1;
constexpr std::uint64_t kMaxClouds = 2;
/// On a coarse level: of 684 fits that ended well, 10 had less there, of 281 others one in twenty had more.
constexpr double kLeastCorrelationCoarse = 0.5;
constexpr std::size_t kMaxFitted = 2;  // of a cloud's survivors
constexpr std::size_t kMaxBases = 2;   // of clouds: hypotheses, or cold starts
/// Of the next frame's motion noise: nearer than this, the path and its reverse lead to the same place.
constexpr double kMinReversedDistance = 1.0;
constexpr double kMinReversedPath_px = 2.0;
constexpr double kUsualInterval_s = 1.0 / 30.0;
constexpr double kLogOddsOfFalseTurn = -3.0;  // one in twenty
/// Of the velocity found: at rest, and the path's reverse.
constexpr PathVariation kOtherVelocities[] = {{0.0}, {-1.0}};
/// A path that lies within a longer one, midway or at an end, explains its own pixels nearly as well.
constexpr PathVariation kOtherLengths[] = {{0.7}, {1.4}, {1.4, 0.2}, {1.4, -0.2}};
constexpr double kLongPath_px = 25.0;
/// Where the turn seen says about how long it is.
constexpr double kLongPathWhereSeen_px = 60.0;
constexpr int kMaxLengthRounds = 3;

/// Whether what the corners weigh is about the same; they are the same corners.
bool is_noise_alike(const std::vector<CornerObservation>& a, const std::vector<CornerObservation>& b) {
  constexpr double kMaxRatio = 1.5;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double ratio = a[i].sigma_px / b[i].sigma_px;
    if (!(ratio < kMaxRatio && ratio > 1.0 / kMaxRatio)) return false;
  }
  return true;
}

/// Since the frame before: no exposure is longer, whatever is told of it.
std::optional<double> time_to_bend_s(const BlurFrame& frame) {
  if (!frame.step_s) return std::nullopt;
  return std::max(*frame.step_s, frame.photometric.exposure_s);
}

}  // namespace

std::vector<Explanation> BlurExplainer::explain(const BlurFrame& frame,
                                                const std::vector<MotionHypothesis>& hypotheses) {
  std::vector<Explanation> found = expected(frame, hypotheses);
  if (found.empty() || !is_settled(frame, found.front())) detected(frame, hypotheses, found);
  if (found.empty()) return found;
  if (!is_well_explained(found.front()) || found.front().prior_cost > kMaxExpectedPriorCost)
    vary_path(frame, kOtherVelocities, found);
  vary_length(frame, found);
  search(frame, hypotheses, found);
  mirror(frame, found);
  reverse(frame, found);
  return found;
}

std::vector<Explanation> BlurExplainer::expected(const BlurFrame& frame,
                                                 const std::vector<MotionHypothesis>& hypotheses) {
  std::vector<Explanation> found;
  for (const MotionHypothesis& hypothesis : hypotheses) {
    const auto is_settled_from = [&](const MotionHypothesis& prior) {
      found.push_back(explained(frame, {prior.belief.mean, prior, false},
                                {.least_correlation = kLeastCorrelationCoarse}));
      return is_settled(frame, found.back());
    };
    if (is_settled_from(hypothesis)) break;
    // What was seen to turn may have been something near.
    if (!hypothesis.unaided || (found.back().is_explained() && is_where_seen(found.back()))) continue;
    if (is_settled_from({*hypothesis.unaided, hypothesis.log_odds + kLogOddsOfFalseTurn})) break;
  }
  sort_by_score(found);
  return found;
}

void BlurExplainer::detected(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses,
                             std::vector<Explanation>& found) {
  if (frame.observations.empty()) return;
  std::vector<Pose> predictions;
  for (const MotionHypothesis& hypothesis : hypotheses)
    predictions.push_back(camera_from_map(hypothesis.belief.mean.pose, world_.mode));
  const CandidateOptions options{.expected_sigma_px = options_.corner_sigma_px};
  const std::vector<PoseCandidate> candidates =
      find_pose_candidates(world_.model, frame.observations, predictions, options);
  for (const PoseCandidate& candidate : candidates) {
    for (const Start& start : starts_at(candidate, hypotheses)) found.push_back(explained(frame, start, {}));
  }
  if (!candidates.empty() && std::ranges::all_of(found, &Explanation::is_beyond_prior)) {
    found.clear();  // the motion so far was mistaken
    for (const PoseCandidate& candidate : candidates) {
      for (const Start& start : starts_at(candidate, {})) found.push_back(explained(frame, start, {}));
    }
  }
  sort_by_score(found);
}

std::vector<BlurExplainer::Start> BlurExplainer::starts_at(
    const PoseCandidate& candidate, const std::vector<MotionHypothesis>& hypotheses) const {
  std::vector<Start> starts;
  const Pose pose = pose_from_camera(candidate.T_camera_map, world_.mode);
  for (const MotionHypothesis& hypothesis : hypotheses) {
    if (const auto state = conditioned(hypothesis.belief, pose))
      starts.push_back({*state, hypothesis, false});
  }
  if (!starts.empty()) return starts;
  // A detection that the motion so far did not expect pays as much as any surprise may cost.
  const double log_odds = hypotheses.empty() ? 0.0 : -kMaxScoredPriorCost;
  if (const auto cold = cold_belief(world_, candidate))
    starts.push_back({cold->mean, {*cold, log_odds}, true});
  return starts;
}

bool BlurExplainer::is_settled(const BlurFrame& frame, const Explanation& explanation) {
  return is_well_explained(explanation) && explanation.prior_cost <= kMaxExpectedPriorCost &&
         std::ranges::all_of(frame.observations, [&](const TagObservation& seen) {
           return std::ranges::count(explanation.votes.agreeing, seen.tag_index) > 0;
         });
}

Explanation BlurExplainer::explained(const BlurFrame& frame, const Start& start,
                                     const MotionFitOptions& options) {
  Explanation explanation;
  explanation.fit = fitted(frame, start, options);
  explanation.prior = start.prior;
  explanation.is_cold = start.is_cold;
  explanation.sensitivity = frame.sensitivity;
  if (world_.mode == TrackMode::kJoint) explanation.R_light_map = explanation.fit.state.pose.rotation();
  explanation.votes = votes(frame, explanation.fit.state);
  refit_without_tags_read_as_others(frame, explanation);
  explanation.correlation = widespread_correlation(quorum(explanation.fit.tags, explanation.votes));
  explanation.prior_cost = prior_cost(start.prior.belief, explanation.fit.state);
  if (!start.is_cold)
    explanation.prior_spread = prior_spread(world_, start.prior.by_evidence(), explanation.fit);
  explanation.bend_covariance =
      bend_covariance(bend_of(frame, explanation).sigma, frame.photometric.exposure_s);
  explanation.score =
      log_likelihood(explanation.fit.tags) + start.prior.log_odds - scored_prior_cost(explanation.prior_cost);
  return explanation;
}

MotionFit BlurExplainer::fitted(const BlurFrame& frame, const Start& start, MotionFitOptions options) {
  const auto bent_over_s = time_to_bend_s(frame);
  if (bent_over_s && !start.is_cold) {
    options.acceleration_per_change = acceleration_per_change(*bent_over_s);
    options.velocity_before = start.prior.expected_velocity();
  }
  std::vector<CornerObservation> observed = corners(frame, start.state);
  MotionFit fit = fit_motion(world_, frame.photometric, start.state, start.prior.belief, observed, options);
  std::vector<CornerObservation> as_found = corners(frame, fit.state);
  if (is_noise_alike(observed, as_found)) return fit;
  MotionFitOptions finest = options;
  finest.coarsest_level = 0;
  return fit_motion(world_, frame.photometric, fit.state, start.prior.belief, as_found, finest);
}

void BlurExplainer::refit_without_tags_read_as_others(const BlurFrame& frame, Explanation& explanation) {
  std::vector<TagEvidence> tags = explanation.fit.tags;
  discredit_tags_read_as_others(world_, frame.detections, explanation.fit.state, explanation.votes, tags);
  std::vector<TagEvidence> discredited;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (tags[i].correlation < explanation.fit.tags[i].correlation) discredited.push_back(tags[i]);
  }
  if (discredited.empty()) return;
  for (const TagEvidence& tag : discredited) tag_of(tag).is_hidden = true;
  explanation.fit =
      fitted(frame, {explanation.fit.state, explanation.prior, explanation.is_cold}, {.coarsest_level = 0});
  explanation.votes = votes(frame, explanation.fit.state);
  for (const TagEvidence& tag : discredited) tag_of(tag).is_hidden = false;
  // That they are not seen speaks against the state all the same.
  for (const TagEvidence& tag : discredited) {
    explanation.fit.tags.push_back(tag);
    explanation.fit.equations.push_back({.evidence = tag});
  }
}

std::vector<CornerObservation> BlurExplainer::corners(const BlurFrame& frame,
                                                      const MotionState& state) const {
  return corner_observations(world_, frame.observations, state, frame.photometric.exposure_s,
                             options_.corner_sigma_px);
}

TagVotes BlurExplainer::votes(const BlurFrame& frame, const MotionState& state) const {
  return count_votes(world_, frame.observations, state, frame.photometric.exposure_s,
                     options_.corner_sigma_px);
}

void BlurExplainer::vary_length(const BlurFrame& frame, std::vector<Explanation>& found) {
  const auto is_long = [](const Explanation& explanation) {
    return longest_path_px(explanation) > (is_where_seen(explanation) ? kLongPathWhereSeen_px : kLongPath_px);
  };
  for (int round = 0; round < kMaxLengthRounds && is_long(found.front()); ++round) {
    const double score = found.front().score;
    vary_path(frame, kOtherLengths, found);
    if (found.front().score <= score) return;
  }
}

void BlurExplainer::vary_path(const BlurFrame& frame, std::span<const PathVariation> variations,
                              std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  const Start as_found{best.fit.state, best.prior, best.is_cold};
  std::vector<Sketch> sketches;
  for (const PathVariation& variation : variations) {
    Start start = as_found;
    start.state.pose = pose_after(best.fit.state, variation.shift * frame.photometric.exposure_s);
    start.state.velocity *= variation.factor;
    sketches.push_back(sketched(frame, start, 2));
  }
  const Sketch& better = *std::ranges::max_element(sketches, {}, &Sketch::score);
  if (better.score < sketched(frame, as_found, 1).score) return;
  found.push_back(explained(frame, better.start, {.coarsest_level = 0}));
  sort_by_score(found);
}

BlurExplainer::Sketch BlurExplainer::sketched(const BlurFrame& frame, Start start, int coarsest_level) {
  constexpr int kPixelsPerTag = 196;
  start.state = descend_motion(
      world_, frame.photometric, start.state, start.prior.belief,
      {.coarsest_level = coarsest_level, .finest_level = 1, .max_pixels_per_tag = kPixelsPerTag});
  const std::vector<TagEvidence> tags =
      weigh_evidence(world_, frame.photometric, start.state,
                     {.level = 1, .max_pixels_per_tag = kPixelsPerTag, .is_robust = false});
  const double of_prior = prior_cost(start.prior.belief, start.state);
  return {start, log_likelihood(tags) + start.prior.log_odds - scored_prior_cost(of_prior)};
}

std::vector<BlurExplainer::Start> BlurExplainer::search_bases(const std::vector<MotionHypothesis>& hypotheses,
                                                              const std::vector<Explanation>& found) {
  std::vector<Start> bases;
  for (const MotionHypothesis& hypothesis : hypotheses)
    bases.push_back({hypothesis.belief.mean, hypothesis, false});
  if (!hypotheses.empty()) return bases;
  for (const Explanation& explanation : found) {  // the best of each detection's
    const MotionBelief& belief = explanation.prior.belief;
    const bool is_new = std::ranges::none_of(bases, [&](const Start& base) {
      return base.state.pose.translation() == belief.mean.pose.translation();
    });
    if (is_new && bases.size() < kMaxBases) bases.push_back({belief.mean, explanation.prior, true});
  }
  return bases;
}

void BlurExplainer::search(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses,
                           std::vector<Explanation>& found) {
  const bool is_recent = frame.interval_s && *frame.interval_s <= kMaxSecondCloudAge_s;
  for (std::size_t cloud = 0; cloud < kMaxClouds; ++cloud) {
    const Explanation& best = found.front();
    if (is_well_explained(best)) return;
    if (cloud > 0 && !best.is_cold && (!is_recent || best.correlation >= kPoorCorrelation)) return;
    search_in_cloud(frame, hypotheses, cloud, found);
  }
}

void BlurExplainer::search_in_cloud(const BlurFrame& frame, const std::vector<MotionHypothesis>& hypotheses,
                                    std::size_t cloud, std::vector<Explanation>& found) {
  std::vector<MotionState> seeds;
  for (const Explanation& explanation : found) seeds.push_back(explanation.fit.state);
  const std::vector<Start> bases = search_bases(hypotheses, found);
  std::vector<MotionBelief> beliefs;
  for (const Start& base : bases) beliefs.push_back(base.prior.belief);
  const CloudOptions options{static_cast<int>(1 + cloud) * options_.num_particles, options_.seed,
                             kMaxClouds * frame.index + cloud};
  std::vector<Sketch> sketches;
  for (const auto& [state, belief] : search_cloud(world_, frame.photometric, beliefs, seeds, options))
    sketches.push_back(sketched(frame, {state, bases[belief].prior, bases[belief].is_cold}, 1));
  std::ranges::stable_sort(sketches, std::greater(), &Sketch::score);
  for (std::size_t i = 0; i < std::min(kMaxFitted, sketches.size()); ++i) {
    found.push_back(explained(frame, sketches[i].start, {.coarsest_level = 0}));
    if (is_well_explained(found.back())) break;
  }
  sort_by_score(found);
}

PathBend BlurExplainer::bend_of(const BlurFrame& frame, const Explanation& explanation) const {
  std::optional<Vector6d> expected;
  if (!explanation.is_cold) expected = explanation.prior.expected_velocity();
  return expected_bend(explanation.fit.state.velocity, expected, time_to_bend_s(frame),
                       options_.motion_noise);
}

void BlurExplainer::mirror(const BlurFrame& frame, std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  const std::vector<TagEvidence> tags = explained_tags(best.fit.tags);
  if (tags.size() != 1) return;
  const Pose& T_map_tag = tag_of(tags.front()).tag.T_map_tag;
  const MotionState other = mirrored_state(best.fit.state, T_map_tag, world_.mode);
  if (best.is_cold) {
    // Both tilts were looked at, at rest; but only one of them, perhaps, with this motion.
    Start start{other, best.prior, true};
    start.prior.belief.mean = mirrored_state(best.prior.belief.mean, T_map_tag, world_.mode);
    found.push_back(explained(frame, start, {.coarsest_level = 1}));
  } else if (best.votes.agreeing.empty()) {  // a detection brings both of its tilts along
    const auto state = conditioned(best.prior.belief, other.pose);
    if (!state) return;
    found.push_back(explained(frame, {*state, best.prior, false}, {.coarsest_level = 1}));
  }
  sort_by_score(found);
}

void BlurExplainer::reverse(const BlurFrame& frame, std::vector<Explanation>& found) {
  const Explanation& best = found.front();
  if (longest_path_px(best) < kMinReversedPath_px) return;  // it does not blur
  const MotionBelief here{best.fit.state, Matrix12d::Zero()};
  MotionState state = best.fit.state;
  state.velocity = -state.velocity;  // and the same acceleration: the same places, in the other order
  const double interval_s = frame.interval_s.value_or(kUsualInterval_s);
  const MotionBelief next = predict(here, options_.motion_noise, interval_s);
  const MotionState other = predict(state, interval_s);
  if (distance(next, other.pose) < kMinReversedDistance) return;
  Explanation reversed = path_reversed(best);
  reversed.bend_covariance = bend_covariance(bend_of(frame, reversed).sigma, frame.photometric.exposure_s);
  if (is_better(reversed, best))
    reversed = explained(frame, {state, best.prior, best.is_cold}, {.coarsest_level = 0});
  found.push_back(std::move(reversed));
  sort_by_score(found);
}

}  // namespace apriltrack
