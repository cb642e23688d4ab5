#include "faults/fault_trials.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "faults/split_tag.h"
#include "faults/tag_moves.h"
#include "faults/tag_places.h"
#include "uncertainty/noise_scale.h"
#include "uncertainty/viewpoint_shares.h"

namespace apriltrack {
namespace {

using Kind = TagFinding::Kind;

constexpr std::size_t kLeastAtPlace = 3;  // views
constexpr int kMostShifts = 3;
/// Squares at which a view is rejected (part_adjustment.cpp), by normal noise and by the tails of claims.
constexpr double kRejectedSquares = 8.0 * 4.0 * 4.0, kRejectedSquaresOfClaimed = 8.0 * 12.0 * 12.0;
constexpr double kClearMove =
    2.35;  // of what rejected views cost: three, or more that were explained by half
constexpr double kClearSize = 30.0;  // nats
constexpr double kHopeful = 10.0;    // of a size that is off by a half of itself
constexpr double kFeeOfPlace = 12.0;
constexpr double kMostUnexplained = 0.15;                // of the tag's views
constexpr double kFirstStep = 0.06, kLastStep = 0.0075;  // of the logarithm of a size

bool is_kept(const AdjustedPart& solved, std::size_t view) {
  return std::ranges::binary_search(solved.part.views, view);
}

/// Half the squares; by the tails of what detectors claim, the negative logarithm of their likelihood.
double view_cost(const TagView& view, double squares) {
  return view.claimed_px2 > 0.0 ? 0.5 * (kTailFreedom + 8.0) * std::log1p(squares / kTailFreedom)
                                : 0.5 * squares;
}

/// The cost of all views in question: each by its share of its viewpoint, and none more than one that is
/// rejected.
double cost_of(const Observations& observations, const std::vector<std::size_t>& views,
               const std::vector<double>& shares, const AdjustedPart& solved, const NoiseScale& noise) {
  std::set<int> frames;
  for (const std::size_t v : solved.part.views) frames.insert(observations.views[v].frame);
  MapState state = solved.state;
  state.noise = noise.of_all();
  double sum = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const TagView& view = observations.views[views[i]];
    bool is_valid = frames.contains(view.frame) && std::ranges::binary_search(solved.part.tags, view.tag);
    Vector8d residual = Vector8d::Zero();
    if (is_valid) residual = whitened_residual(observations, view, state, is_valid);
    const double most = cost_of_rejected_view(view);
    sum += shares[i] * (is_valid ? std::min(most, view_cost(view, residual.squaredNorm())) : most);
  }
  return sum;
}

/// The moment, or where the views that are given up beside it end.
std::size_t shifted_moment(const Suspect& suspect, const FaultTrial& trial, std::size_t moment) {
  std::size_t shifted = moment;
  while (shifted > 0 && !is_kept(trial.solved, suspect.views[shifted - 1])) --shifted;
  if (shifted != moment) return shifted;
  while (shifted < suspect.views.size() && !is_kept(trial.solved, suspect.views[shifted])) ++shifted;
  return shifted;
}

/// Where the tag was not seen for the longest time.
std::size_t moment_after_gap(const Observations& observations, const Suspect& suspect) {
  const auto time = [&](std::size_t i) {
    return observations.frames[static_cast<std::size_t>(observations.views[suspect.views[i]].frame)];
  };
  std::size_t best = 0;
  double longest_s = 0.0;
  for (std::size_t i = 1; i < suspect.views.size(); ++i) {
    const double gap_s = seconds_between(time(i - 1), time(i));
    if (gap_s <= longest_s) continue;
    longest_s = gap_s;
    best = i;
  }
  return best;
}

double apart_m(const FaultTrial& trial) {
  return (trial.T_map_first.translation() - trial.T_map_second.translation()).norm();
}

void keep_better(std::optional<FaultTrial>& best, std::optional<FaultTrial> trial, double least_gain = 0.0) {
  if (trial && (!best || trial->gain > best->gain + least_gain)) best = std::move(trial);
}

/// Of three trials of sizes, a step apart: where the gain is greatest by the parabola.
double at_vertex(const FaultTrial& middle, double gain_below, double gain_above, double step) {
  const double bend = 2.0 * middle.gain - gain_below - gain_above;
  if (!(bend > 0.0)) return middle.log_scale;
  return middle.log_scale + step * std::clamp(0.5 * (gain_above - gain_below) / bend, -1.0, 1.0);
}

}  // namespace

double cost_of_rejected_view(const TagView& view) {
  return view_cost(view, view.claimed_px2 > 0.0 ? kRejectedSquaresOfClaimed : kRejectedSquares);
}

FaultTrials::FaultTrials(const PartTask& task, const Suspect& suspect, const AdjustedPart& solved)
    : task_(task), suspect_(suspect), solved_(solved), observations_(task.observations) {
  observations_.cameras = solved.state.cameras;
  whole_ = solve_anew({observations_, task.candidates, task.options}, suspect.part.views, suspect.tag);
  for (const std::size_t v : suspect.views) is_given_up_.push_back(!is_kept(whole_ ? *whole_ : solved, v));
  ask_probes();
}

// What frames that show others of the map say to begin with.
void FaultTrials::ask_probes() {
  const PartTask task{observations_, task_.candidates, task_.options};
  const std::vector<ProbeView> probes = probe_views(task, suspect_.part, solved_, suspect_.tag);
  if (probes.size() < 2 * kLeastAtPlace) return;
  const auto rank_of = [&](const ProbeView& probe) {
    const auto view = static_cast<std::size_t>(probe.view - observations_.views.data());
    return static_cast<std::size_t>(std::ranges::lower_bound(suspect_.views, view) - suspect_.views.begin());
  };
  const TagFit one = fit_tag_anew(probes, size_m());
  if (const auto moved = moved_once(probes, one, size_m())) {
    const auto second = std::ranges::find(moved->is_at_second, true) - moved->is_at_second.begin();
    moment_of_probes_ = rank_of(probes[static_cast<std::size_t>(second)]);
  }
  const auto two = two_places(probes, one, size_m());
  if (!two) return;
  const auto at_second = std::ranges::count(two->is_at_second, true);
  places_of_probes_.assign(suspect_.views.size(), 2 * at_second > std::ssize(two->is_at_second));
  for (std::size_t i = 0; i < probes.size(); ++i)
    places_of_probes_[rank_of(probes[i])] = two->is_at_second[i];
}

// What is explained by two places, one after the other, needs none by turns; and a size has fewer unknowns.
std::optional<FaultTrial> FaultTrials::best() {
  std::optional<FaultTrial> best;
  keep_better(best, if_enough(best_size()));
  std::optional<FaultTrial> places = best_move();
  if (!places || !explains_all(*places)) {
    std::optional<FaultTrial> copy = best_copy();
    if (copy && (!places || apart_m(*copy) > kOneObject_m)) keep_better(places, std::move(copy), kFeeOfPlace);
  }
  keep_better(best, std::move(places), kFeeOfPlace);
  if (best && best->kind == Kind::kMoved && apart_m(*best) < kOneObject_m && moves_again(*best))
    best->kind = Kind::kLoose;
  return best;
}

std::optional<FaultTrial> FaultTrials::try_fault(const Observations& observations, FaultTrial trial) const {
  auto solved = solve_anew({observations, task_.candidates, task_.options}, suspect_.part.views, suspect_.tag,
                           MirrorTests::kBefore);
  if (!solved) return std::nullopt;
  const NoiseScale noise = solved->state.noise;
  const std::vector<std::size_t>& views = suspect_.part.views;
  const std::vector<double> shares = viewpoint_shares(observations, solved->state, views);
  double without = cost_of(observations_, views, shares, solved_, noise);
  if (whole_) without = std::min(without, cost_of(observations_, views, shares, *whole_, noise));
  trial.gain = without - cost_of(observations, views, shares, *solved, noise);
  trial.solved = std::move(*solved);
  return trial;
}

Observations FaultTrials::split_suspect(const std::vector<bool>& is_at_second) const {
  return split_tag(observations_, suspect_.tag, suspect_.views, is_at_second);
}

std::optional<FaultTrial> FaultTrials::split(Kind kind, const std::vector<bool>& is_at_second) {
  auto known = splits_.find(is_at_second);
  if (known == splits_.end()) known = splits_.emplace(is_at_second, solve_split(is_at_second)).first;
  std::optional<FaultTrial> result = known->second;
  if (result) result->kind = kind;
  return result;
}

std::optional<FaultTrial> FaultTrials::solve_split(const std::vector<bool>& is_at_second) const {
  FaultTrial trial;
  trial.is_at_second = is_at_second;
  auto result = try_fault(split_suspect(is_at_second), std::move(trial));
  if (!result) return result;
  result->T_map_first = result->solved.state.T_map_tag[static_cast<std::size_t>(suspect_.tag)];
  result->T_map_second = result->solved.state.T_map_tag.back();
  return result;
}

bool FaultTrials::moves_again(const FaultTrial& moved) const {
  const Observations observations = split_suspect(moved.is_at_second);
  const auto second = static_cast<int>(observations.tags.size()) - 1;
  return do_move_again({observations, task_.candidates, task_.options}, moved.solved, {suspect_.tag, second},
                       on_one_thread(task_));
}

std::optional<FaultTrial> FaultTrials::move_at(std::size_t moment) {
  std::vector<bool> is_at_second(suspect_.views.size());
  std::fill(is_at_second.begin() + static_cast<std::ptrdiff_t>(moment), is_at_second.end(), true);
  return split(Kind::kMoved, is_at_second);
}

std::optional<FaultTrial> FaultTrials::best_move_from(std::size_t moment) {
  std::optional<FaultTrial> best;
  for (int shift = 0; shift <= kMostShifts; ++shift) {
    if (moment < kLeastAtPlace || moment + kLeastAtPlace > suspect_.views.size()) break;
    std::optional<FaultTrial> trial = move_at(moment);
    if (!trial || (best && trial->gain <= best->gain)) break;
    best = std::move(trial);
    const std::size_t next = shifted_moment(suspect_, *best, moment);
    if (next == moment) break;
    moment = next;
  }
  return best;
}

std::optional<FaultTrial> FaultTrials::best_move() {
  const std::size_t num = suspect_.views.size();
  std::optional<FaultTrial> best;
  for (const std::size_t moment :
       {moment_of_probes_, moment_of_change(is_given_up_), moment_after_gap(observations_, suspect_), num / 4,
        num / 2, 3 * num / 4}) {
    keep_better(best, if_enough(best_move_from(moment)));
    if (best && explains_all(*best)) return best;
  }
  return best;
}

// What one place does not explain shows the other.
std::optional<FaultTrial> FaultTrials::best_copy() {
  std::optional<FaultTrial> best = if_enough(best_copy_from(is_given_up_));
  keep_better(best, if_enough(best_copy_from(places_of_probes_)));
  if (best && is_one_change(best->is_at_second)) best->kind = Kind::kMoved;
  return best;
}

std::optional<FaultTrial> FaultTrials::best_copy_from(std::vector<bool> is_at_second) {
  std::optional<FaultTrial> best;
  for (int round = 0; round <= kMostShifts; ++round) {
    const auto num = static_cast<std::size_t>(std::ranges::count(is_at_second, true));
    if (num < kLeastAtPlace || num + kLeastAtPlace > suspect_.views.size()) break;
    std::optional<FaultTrial> trial = split(Kind::kTwoPlaces, is_at_second);
    if (!trial || (best && trial->gain <= best->gain)) break;
    best = std::move(trial);
    for (std::size_t i = 0; i < suspect_.views.size(); ++i) {
      if (!is_kept(best->solved, suspect_.views[i])) is_at_second[i] = !is_at_second[i];
    }
  }
  return best;
}

std::optional<FaultTrial> FaultTrials::resize(double log_scale) const {
  Observations resized = observations_;
  resized.sizes_m[static_cast<std::size_t>(suspect_.tag)] *= std::exp(log_scale);
  FaultTrial trial;
  trial.kind = Kind::kSize;
  trial.log_scale = log_scale;
  return try_fault(resized, std::move(trial));
}

std::optional<FaultTrial> FaultTrials::best_size() const {
  std::optional<FaultTrial> best;
  for (const double steps : {-4.0, -2.0, -1.0, 1.0, 2.0, 4.0}) keep_better(best, resize(steps * kFirstStep));
  if (!best || best->gain < kHopeful) return std::nullopt;
  for (double step = 0.5 * kFirstStep; step > 0.9 * kLastStep; step *= 0.5) {
    const double middle = best->log_scale;
    auto below = resize(middle - step), above = resize(middle + step);
    const bool are_both = below && above;
    const double gain_below = are_both ? below->gain : 0.0, gain_above = are_both ? above->gain : 0.0;
    keep_better(best, std::move(below));
    keep_better(best, std::move(above));
    if (are_both && step < 1.1 * kLastStep && best->log_scale == middle)
      best->log_scale = at_vertex(*best, gain_below, gain_above, step);
  }
  best->scale_sigma = std::abs(best->log_scale) / std::sqrt(2.0 * best->gain);  // half the squares are gained
  return best;
}

std::optional<FaultTrial> FaultTrials::if_enough(std::optional<FaultTrial> trial) const {
  if (!trial) return trial;
  std::size_t at_first = 0, at_second = 0;
  for (std::size_t i = 0; i < suspect_.views.size(); ++i) {
    if (!is_kept(trial->solved, suspect_.views[i])) continue;
    ++(trial->is_at_second.empty() || !trial->is_at_second[i] ? at_first : at_second);
  }
  const auto num = static_cast<double>(suspect_.views.size());
  if (num - static_cast<double>(at_first + at_second) > kMostUnexplained * num) return std::nullopt;
  const double clear_move = kClearMove * cost_of_rejected_view(observations_.views[suspect_.views.front()]);
  const bool is_clear =
      trial->kind == Kind::kSize
          ? trial->gain > kClearSize && std::abs(trial->log_scale) > kClearScale
          : trial->gain > clear_move && std::min(at_first, at_second) >= kLeastAtPlace && are_apart(*trial);
  return is_clear ? std::move(trial) : std::nullopt;
}

bool FaultTrials::explains_all(const FaultTrial& trial) const {
  return std::ranges::all_of(suspect_.views, [&](std::size_t v) { return is_kept(trial.solved, v); });
}

bool FaultTrials::are_apart(const FaultTrial& trial) const {
  const Pose change = trial.T_map_first.inverse() * trial.T_map_second;
  const double least_m =
      trial.kind == Kind::kMoved ? least_shift_m(change, size_m()) : least_between_tags_m(change, size_m());
  return change.translation().norm() > least_m;
}

double FaultTrials::size_m() const {
  return observations_.sizes_m[static_cast<std::size_t>(suspect_.tag)];
}

}  // namespace apriltrack
