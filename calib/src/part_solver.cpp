#include "part_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "apriltrack/base/error.h"
#include "bundle_adjustment.h"
#include "contradictions.h"
#include "mirror_test.h"
#include "noise_correlation.h"
#include "tag_covariance.h"
#include "view_residual.h"

namespace apriltrack {
namespace {

constexpr double kCoarseLoss = 30.0;       // views are some ten pixels off at the start
constexpr double kFineLossPerSigma = 6.0;  // a good view's whitened norm is sqrt(8)
constexpr double kMaxViewRms = 4.0;        // sigmas; one in 1e18 good views
constexpr double kMaxComponent = 6.0;      // sigmas; one corner off, the rest of the tag in place
constexpr double kMinScale = 0.1;  // sigmas are never taken for smaller than a tenth of those expected
// The expected sigma counts as this many residuals beside those of the fit, as in the localizer: many views
// speak for themselves, while a few, whose residuals may all be small by chance, claim no more than is known.
constexpr double kPriorStrength = 3.0;
constexpr int kMaxRounds = 4;
constexpr double kNonsense_px = 5.0;
constexpr std::string_view kWhatToCheck =
    "check the tag family (--family) and the tag sizes, the camera file, and that no tag was moved while "
    "filming";

Vector8d whitened_residual(const Observations& observations, const TagView& view, const MapState& state,
                           bool& is_valid, Vector8d* residual_px = nullptr) {
  Vector8d residual = Vector8d::Zero();
  is_valid = view_residual(observations.cameras[static_cast<std::size_t>(view.camera)],
                           observations.sizes_m[static_cast<std::size_t>(view.tag)], view.corners_px,
                           state.T_map_rig[static_cast<std::size_t>(view.frame)],
                           state.T_map_tag[static_cast<std::size_t>(view.tag)], &residual, nullptr, nullptr);
  if (residual_px != nullptr) *residual_px = residual;
  return view.whitening * residual;
}

/// Residuals beyond what the unknowns (each frame's pose, and the tags' but one) can make vanish.
double degrees_of_freedom(const Observations& observations, const std::vector<std::size_t>& views) {
  std::set<int> tags, frames;
  for (const std::size_t v : views) {
    tags.insert(observations.views[v].tag);
    frames.insert(observations.views[v].frame);
  }
  const double unknowns = 6.0 * static_cast<double>(tags.size() + frames.size()) - 6.0;
  return 8.0 * static_cast<double>(views.size()) - unknowns;
}

/// Standard deviation of the whitened residuals, from their median: half of them may be wrong. Where there
/// are few, the fit makes many of them vanish, and the median with them: the expected sigma counts as well.
double robust_scale(const Observations& observations, const std::vector<std::size_t>& views,
                    const MapState& state) {
  std::vector<double> magnitudes;
  for (const std::size_t v : views) {
    bool is_valid = false;
    const Vector8d whitened = whitened_residual(observations, observations.views[v], state, is_valid);
    for (int i = 0; is_valid && i < 8; ++i) magnitudes.push_back(std::abs(whitened[i]));
  }
  if (magnitudes.empty()) return 1.0;
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  constexpr double kSigmaPerMedian = 1.4826;  // of a normal distribution
  const double by_median = kSigmaPerMedian * *middle;
  constexpr double kExpectedResiduals = 15.0;  // two frames of two tags leave 14
  const double freedom = std::max(0.0, degrees_of_freedom(observations, views));
  return std::max(kMinScale, std::sqrt((kExpectedResiduals + freedom * by_median * by_median) /
                                       (kExpectedResiduals + freedom)));
}

std::vector<std::size_t> inliers(const Observations& observations, const std::vector<std::size_t>& views,
                                 const MapState& state) {
  const double scale = robust_scale(observations, views, state);
  std::vector<std::size_t> kept;
  for (const std::size_t v : views) {
    bool is_valid = false;
    const Vector8d whitened = whitened_residual(observations, observations.views[v], state, is_valid) / scale;
    const double rms = std::sqrt(whitened.squaredNorm() / 8.0);
    if (is_valid && rms <= kMaxViewRms && whitened.cwiseAbs().maxCoeff() <= kMaxComponent) kept.push_back(v);
  }
  return kept;
}

[[noreturn]] void fail_as_contradictory(const Observations& observations, int held_tag) {
  throw no_result("calibrate", fmt::format("the observations around {} contradict each other: {}",
                                           to_string(observations.tags[static_cast<std::size_t>(held_tag)]),
                                           kWhatToCheck));
}

/// What of `part` the views still tie to the held tag; an empty part when it stands alone.
Part connected_to(const Observations& observations, const std::vector<std::size_t>& views, int held_tag,
                  int min_views) {
  for (Part& part : find_parts(observations, views, min_views).parts) {
    if (std::binary_search(part.tags.begin(), part.tags.end(), held_tag)) return std::move(part);
  }
  return {};
}

std::vector<int> free_tags(const Part& part, int held_tag) {
  std::vector<int> tags = part.tags;
  std::erase(tags, held_tag);
  return tags;
}

void adjust_robustly(const Observations& observations, const Part& part, int held_tag,
                     const CalibrationOptions& options, MapState& state) {
  // Steps that run out here are no failure yet: the clean adjustment must converge.
  const auto adjust_with_loss = [&](double loss_scale) {
    const AdjustmentSummary summary = adjust(observations, part.views, free_tags(part, held_tag),
                                             {loss_scale, options.max_iterations}, state);
    if (!summary.is_usable)
      throw no_result("calibrate", fmt::format("the robust adjustment of {} tags failed ({}); {}",
                                               part.tags.size(), summary.message, kWhatToCheck));
  };
  adjust_with_loss(kCoarseLoss);
  adjust_with_loss(kFineLossPerSigma * robust_scale(observations, part.views, state));
}

/// Least squares over the inliers, which are chosen anew until they stay the same.
Part adjust_cleanly(const Observations& observations, const Part& part, int held_tag,
                    const CalibrationOptions& options, MapState& state) {
  Part kept;
  for (int round = 0; round < kMaxRounds; ++round) {
    Part next =
        connected_to(observations, inliers(observations, part.views, state), held_tag, options.min_views);
    if (next.tags.size() < 2) fail_as_contradictory(observations, held_tag);
    if (next.views == kept.views) return kept;
    kept = std::move(next);
    const AdjustmentSummary summary =
        adjust(observations, kept.views, free_tags(kept, held_tag),
               {.loss_scale = 0.0, .max_iterations = options.max_iterations}, state);
    if (!summary.is_usable || !summary.has_converged)
      throw no_result("calibrate",
                      fmt::format("the adjustment of {} tags did not converge ({}); more views of each tag, "
                                  "from more sides, usually help",
                                  kept.tags.size(), summary.message));
  }
  return kept;
}

void measure_residuals(const Observations& observations, PartSolution& solution, double& whitened_sum) {
  std::vector<double> sums(observations.tags.size(), 0.0);
  std::vector<int> counts(observations.tags.size(), 0);
  double total = 0.0;
  whitened_sum = 0.0;
  for (const std::size_t v : solution.part.views) {
    const TagView& view = observations.views[v];
    bool is_valid = false;
    Vector8d residual_px;
    whitened_sum +=
        whitened_residual(observations, view, solution.state, is_valid, &residual_px).squaredNorm();
    sums[static_cast<std::size_t>(view.tag)] += residual_px.squaredNorm();
    counts[static_cast<std::size_t>(view.tag)] += 8;
    total += residual_px.squaredNorm();
  }
  for (const int tag : solution.part.tags) {
    const auto t = static_cast<std::size_t>(tag);
    solution.residual_rms_px.push_back(std::sqrt(sums[t] / std::max(counts[t], 1)));
  }
  solution.total_rms_px = std::sqrt(total / (8.0 * static_cast<double>(solution.part.views.size())));
}

/// Two shares: noise, scaled by what the residuals show of it (a scaled inverse chi-squared prior at the
/// expected sigma) and by how much neighbouring frames repeat it; and errors that each tag keeps in all of
/// its views, which the fit hides from the residuals.
void measure_covariances(const Observations& observations, const CalibrationOptions& options,
                         PartSolution& solution) {
  double whitened_sum = 0.0;
  measure_residuals(observations, solution, whitened_sum);
  if (solution.part.tags.size() > static_cast<std::size_t>(options.max_tags_with_covariance)) return;
  const auto covariances = tag_covariances(observations, solution.part, solution.held_tag, solution.state);
  if (!covariances)
    throw no_result("calibrate",
                    "the views leave the pose of a tag undetermined; film each tag from more sides, together "
                    "with others");
  const double freedom = degrees_of_freedom(observations, solution.part.views);
  const double repetition = views_per_independent_view(observations, solution.part, solution.state);
  // In units of the expected variance: 1 when the residuals are as large as corner_sigma_px says.
  const double variance =
      std::max(kMinScale * kMinScale, (kPriorStrength + whitened_sum) / (kPriorStrength + freedom));
  const double bias = options.corner_bias_px / options.corner_sigma_px;
  for (const TagCovariance& tag : *covariances)
    solution.covariances.push_back({variance * repetition * tag.by_noise, bias * bias * tag.by_bias});
}

/// Everything that the solving of a part needs besides the part.
struct Task {
  const Observations& observations;
  const std::vector<ViewCandidates>& candidates;
  const CalibrationOptions& options;
};

/// An adjusted part, and how it agrees with its frames.
struct Attempt {
  int held_tag = 0;
  Part part;
  MapState state;
  Contradictions contradictions;
  std::optional<int> culprit = std::nullopt;  ///< Left out before.
};

Attempt attempt(const Task& task, const Part& part, int held_tag, const ParallelFor& parallel) {
  const auto& [observations, candidates, options] = task;
  Attempt result{.held_tag = held_tag,
                 .part = {},
                 .state = start_state(observations, part, held_tag, candidates, parallel),
                 .contradictions = {}};
  adjust_robustly(observations, part, held_tag, options, result.state);
  for (int round = 0; round < kMaxRounds; ++round) {
    if (turn_mirrored_tags(observations, part, held_tag, result.state).empty()) break;
    adjust_robustly(observations, part, held_tag, options, result.state);
  }
  result.part = adjust_cleanly(observations, part, held_tag, options, result.state);
  result.contradictions =
      find_contradictions(observations, part, inliers(observations, part.views, result.state));
  return result;
}

/// The same without one tag; nullopt where nothing is left, where it is held by choice, and where what is
/// left contradicts itself.
std::optional<Attempt> attempt_without(const Task& task, const Part& part, int tag, int held_tag) {
  const auto& [observations, candidates, options] = task;
  std::vector<std::size_t> views = part.views;
  std::erase_if(views, [&](std::size_t v) { return task.observations.views[v].tag == tag; });
  Part rest;
  if (tag != held_tag) {
    rest = connected_to(observations, views, held_tag, options.min_views);
  } else if (!options.held_tag || observations.tags[static_cast<std::size_t>(tag)] != *options.held_tag) {
    std::vector<Part> parts = find_parts(observations, views, options.min_views).parts;
    if (!parts.empty()) rest = std::move(parts.front());
  }
  if (rest.tags.size() < 2) return std::nullopt;
  try {
    Attempt result = attempt(task, rest, tag == held_tag ? rest.tags.front() : held_tag, parallel_for(1));
    if (result.contradictions.are_there()) return std::nullopt;
    return result;
  } catch (const Error&) {  // contradictory, or not converged: so this tag is not the cause
    return std::nullopt;
  }
}

/// Tags whose absence might explain the contradictions: any of a small map, for an id that hangs in two
/// places folds the map, and frames far from both are rejected; of a large one those that are rejected.
std::vector<int> suspects(const Part& part, const Contradictions& contradictions) {
  constexpr std::size_t kMaxTrials = 40;
  if (part.tags.size() <= kMaxTrials) return part.tags;
  std::set<int> tags(contradictions.tags.begin(), contradictions.tags.end());
  for (const auto& [a, b] : contradictions.links) tags.insert({a, b});
  std::vector<int> some(tags.begin(), tags.end());
  some.resize(std::min(some.size(), kMaxTrials));
  return some;
}

[[noreturn]] void fail_with_contradictions(const Observations& observations,
                                           const Contradictions& contradictions) {
  const auto name = [&](int tag) { return to_string(observations.tags[static_cast<std::size_t>(tag)]); };
  std::string what;
  for (const int tag : contradictions.tags) what += (what.empty() ? "" : ", ") + name(tag);
  for (const auto& [a, b] : contradictions.links)
    what += (what.empty() ? "" : ", ") + name(a) + " with " + name(b);
  throw no_result("calibrate",
                  fmt::format("{} of {} frames contradict the others, and no one tag is clearly the cause; "
                              "most contradicted: {}. Does an id hang in two places? {}",
                              contradictions.contradicting, contradictions.frames, what, kWhatToCheck));
}

/// The part without the one tag whose absence leaves no contradictions, and the most tags.
Attempt without_culprit(const Task& task, const Part& part, const Attempt& first, const ParallelFor& parallel,
                        const LogSink& log) {
  const Contradictions& contradictions = first.contradictions;
  const std::vector<int> tags = suspects(part, contradictions);
  std::vector<std::optional<Attempt>> trials(tags.size());
  if (2 * contradictions.contradicting <= contradictions.frames)
    parallel(tags.size(),
             [&](std::size_t i) { trials[i] = attempt_without(task, part, tags[i], first.held_tag); });
  std::size_t best = tags.size(), most = 0, num_best = 0;  // of those that help
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const std::size_t kept = trials[i] ? trials[i]->part.tags.size() : 0;
    if (kept > most) {
      best = i;
      most = kept;
      num_best = 0;
    }
    if (kept == most && kept > 0) ++num_best;
  }
  if (num_best != 1) fail_with_contradictions(task.observations, contradictions);
  log(LogLevel::kInfo, fmt::format("{} is left out: with it, {} of {} frames contradict each other",
                                   to_string(task.observations.tags[static_cast<std::size_t>(tags[best])]),
                                   contradictions.contradicting, contradictions.frames));
  Attempt result = std::move(*trials[best]);
  result.culprit = tags[best];
  return result;
}

}  // namespace

PartSolution solve_part(const Observations& observations, const Part& part, int held_tag,
                        const std::vector<ViewCandidates>& candidates, const CalibrationOptions& options,
                        const ParallelFor& parallel, const LogSink& log) {
  const Task task{observations, candidates, options};
  Attempt solved = attempt(task, part, held_tag, parallel);
  if (solved.contradictions.are_there()) solved = without_culprit(task, part, solved, parallel, log);
  PartSolution solution;
  solution.held_tag = solved.held_tag;
  solution.culprit = solved.culprit;
  solution.part = std::move(solved.part);
  solution.state = std::move(solved.state);
  measure_covariances(observations, options, solution);

  solution.views_offered = part.views.size();
  solution.views_offered_by_tag.assign(observations.tags.size(), 0);
  for (const std::size_t v : part.views)
    ++solution.views_offered_by_tag[static_cast<std::size_t>(observations.views[v].tag)];
  std::set_difference(part.tags.begin(), part.tags.end(), solution.part.tags.begin(),
                      solution.part.tags.end(), std::back_inserter(solution.lost_tags));
  if (solution.culprit) std::erase(solution.lost_tags, *solution.culprit);
  if (!(solution.total_rms_px < kNonsense_px))
    throw no_result(
        "calibrate",
        fmt::format("the adjusted map leaves errors of {:.1f} px: {}; corners from elsewhere must "
                    "come in the order bottom-left, bottom-right, top-right, top-left",
                    solution.total_rms_px, kWhatToCheck));
  return solution;
}

}  // namespace apriltrack
