#include "faults/tag_trials.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "apriltrack/base/parallel.h"
#include "faults/fault_trials.h"
#include "faults/tag_neighbourhoods.h"
#include "faults/tag_places.h"
#include "numerics/upper_median.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostSuspectsTried = 8;
constexpr double kAsMany = 0.8;        // a partner, whatever share of its views that is
constexpr double kLeastShare = 0.08;   // of the tag's views
constexpr double kBeyondOthers = 1.5;  // times the share that half of the tags lose
constexpr double kShareOfMost = 0.2;   // of what the first lost
constexpr std::size_t kLeastGivenUp = 3, kLeastViewsOfSuspect = 4;
constexpr std::size_t kMostFramesTried = 120;  // of a tag; and as many others
constexpr double kSureFrames = 0.7;            // of those that were given up
constexpr double kNoClearLead = 1.56;          // of what rejected views cost: less than two of them
constexpr double kAsGood = 0.5;                // of the gain, where that is small

/// Of one tag's views.
struct GivenUp {
  int tag = 0;
  std::size_t views = 0, of = 0;

  double share() const { return static_cast<double>(views) / static_cast<double>(of); }
  bool is_all() const { return views == of; }
};

/// Of all tags.
std::vector<GivenUp> count_given_up(const Observations& observations, const Part& part,
                                    const AdjustedPart& solved) {
  std::map<int, GivenUp> by_tag;
  for (const std::size_t v : part.views) {
    const int tag = observations.views[v].tag;
    GivenUp& one = by_tag.try_emplace(tag, GivenUp{tag, 0, 0}).first->second;
    ++one.of;
    if (!std::ranges::binary_search(solved.part.views, v)) ++one.views;
  }
  std::vector<GivenUp> result;
  for (const auto& [tag, one] : by_tag) result.push_back(one);
  return result;
}

/// Those that lost more views than outliers cost the others; most first.
std::vector<int> tags_given_up(const Observations& observations, const Part& part,
                               const AdjustedPart& solved) {
  std::vector<GivenUp> all = count_given_up(observations, part, solved);
  if (all.empty()) return {};
  std::vector<double> shares;
  for (const GivenUp& one : all) shares.push_back(one.share());
  const double of_others = kBeyondOthers * upper_median(std::move(shares));
  std::size_t most = 0;
  for (const GivenUp& one : all) most = std::max(most, one.is_all() ? 0 : one.views);
  std::erase_if(all, [&](const GivenUp& one) {
    const double of_most =
        static_cast<double>(one.views) / static_cast<double>(std::max<std::size_t>(most, 1));
    const bool is_partner =
        one.share() > of_others && of_most >= (one.share() >= kLeastShare ? kShareOfMost : kAsMany);
    return one.views < kLeastGivenUp || !(is_partner || one.is_all());
  });
  std::ranges::sort(all, std::greater<>(), [](const GivenUp& one) { return std::pair(one.views, -one.tag); });
  std::vector<int> tags;
  for (const GivenUp& one : all) tags.push_back(one.tag);
  return tags;
}

Suspect to_suspect(const Observations& observations, const TagNeighbourhoods& neighbourhoods, int tag) {
  Suspect suspect{tag, neighbourhoods.around(tag), {}};
  std::ranges::copy_if(suspect.part.views, std::back_inserter(suspect.views),
                       [&](std::size_t v) { return observations.views[v].tag == tag; });
  return suspect;
}

std::vector<Suspect> find_suspects(const PartTask& task, const Part& part, const AdjustedPart& solved) {
  std::vector<int> suspected = tags_given_up(task.observations, part, solved), others = part.tags;
  const auto is_told = [&](int tag) { return do_frames_tell(task, part, solved, tag); };
  std::set<int> told;
  std::ranges::copy_if(suspected, std::inserter(told, told.end()), is_told);
  std::erase_if(suspected, [&](int tag) { return told.contains(tag); });
  suspected.resize(std::min(suspected.size(), kMostSuspectsTried));
  std::vector<Suspect> suspects;
  if (suspected.empty()) return suspects;
  std::erase_if(others, [&](int tag) { return told.contains(tag); });
  const TagNeighbourhoods neighbourhoods(task.observations, narrowed_to(task.observations, part, others),
                                         kMostFramesTried);
  for (const int tag : suspected) {
    Suspect suspect = to_suspect(task.observations, neighbourhoods, tag);
    if (suspect.views.size() >= kLeastViewsOfSuspect) suspects.push_back(std::move(suspect));
  }
  return suspects;
}

PlaceChange places_of(const Observations& observations, const Suspect& suspect, const FaultTrial& trial) {
  TwoPlaces two{};
  two.fit.T_map_tag = trial.T_map_first;
  two.second.T_map_tag = trial.T_map_second;
  two.is_at_second = trial.is_at_second;
  put_first_view_first(two);
  if (trial.kind == TagFinding::Kind::kTwoPlaces) return change_by_turns(two);
  std::vector<Timestamp> times;
  for (const std::size_t v : suspect.views)
    times.push_back(observations.frames[static_cast<std::size_t>(observations.views[v].frame)]);
  return change_at_a_moment(two, times);
}

TagFinding to_finding(const Observations& observations, const Suspect& suspect, const FaultTrial& trial,
                      bool is_alone) {
  TagFinding finding;
  finding.tag = suspect.tag;
  finding.kind = trial.kind;
  finding.is_left_out = true;
  finding.num_views = suspect.views.size();
  finding.blame = is_alone ? TagFinding::Blame::kThisTag : TagFinding::Blame::kThisOrAnother;
  if (trial.kind == TagFinding::Kind::kSize)
    finding.shape = ShapeError{.size_m = observations.sizes_m[static_cast<std::size_t>(suspect.tag)],
                               .log_scale = trial.log_scale,
                               .scale_sigma = trial.scale_sigma};
  if (trial.kind == TagFinding::Kind::kMoved || trial.kind == TagFinding::Kind::kTwoPlaces)
    finding.places = places_of(observations, suspect, trial);
  if (trial.kind != TagFinding::Kind::kLoose) {
    for (std::size_t i = 0; i < trial.is_at_second.size(); ++i)
      finding.views_by_place[trial.is_at_second[i] ? 1 : 0].push_back(suspect.views[i]);
  }
  return finding;
}

}  // namespace

bool do_frames_tell(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag) {
  const std::vector<ProbeView> probes = probe_views(task, part, solved, tag);
  const auto is_given_up = [&](std::size_t v) { return !std::ranges::binary_search(solved.part.views, v); };
  std::size_t views = 0, given_up = 0, sure = 0, sure_given_up = 0;
  for (const std::size_t v : part.views) {
    if (task.observations.views[v].tag != tag) continue;
    ++views;
    if (is_given_up(v)) ++given_up;
  }
  for (const ProbeView& probe : probes) {
    if (!probe.is_frame_sure) continue;
    ++sure;
    if (is_given_up(static_cast<std::size_t>(probe.view - task.observations.views.data()))) ++sure_given_up;
  }
  const auto are_most = [&](std::size_t some, std::size_t all) {  // of many, some are probed
    const double probed = std::min(1.0, static_cast<double>(kMostProbes) / static_cast<double>(views));
    return static_cast<double>(some) >= kSureFrames * probed * static_cast<double>(all);
  };
  const auto finding = look_at(task, solved, probes, tag).finding;
  const bool is_complete = finding && finding->is_complete();
  const bool is_always_so = is_complete && (finding->kind == TagFinding::Kind::kSize ||
                                            finding->kind == TagFinding::Kind::kNotFlat);
  if (is_always_so && are_most(sure, views)) return true;
  const bool is_in_map = std::ranges::binary_search(solved.part.tags, tag);
  return (is_complete || is_in_map) && are_most(sure_given_up, given_up);
}

std::vector<std::vector<TagFinding>> find_faults_by_trial(const PartTask& task, const Part& part,
                                                          const AdjustedPart& solved,
                                                          const ParallelFor& parallel) {
  const std::vector<Suspect> suspects = find_suspects(task, part, solved);
  std::vector<std::optional<FaultTrial>> trials(suspects.size());
  parallel(suspects.size(),
           [&](std::size_t i) { trials[i] = FaultTrials(task, suspects[i], solved).best(); });
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < trials.size(); ++i)
    if (trials[i]) left.push_back(i);
  std::ranges::stable_sort(left, std::greater<>(), [&](std::size_t i) { return trials[i]->gain; });
  std::vector<std::vector<TagFinding>> alternatives;
  while (!left.empty()) {
    const double most = trials[left.front()]->gain;
    const TagView& of_first = task.observations.views[suspects[left.front()].views.front()];
    const double clear_lead = kNoClearLead * cost_of_rejected_view(of_first);
    const auto is_worse = [&](std::size_t i) {
      return trials[i]->gain <= most - std::min(clear_lead, kAsGood * most);
    };
    const auto end = std::ranges::find_if(left, is_worse);
    const bool is_alone = end - left.begin() == 1;
    std::vector<TagFinding>& findings = alternatives.emplace_back();
    for (auto i = left.begin(); i != end; ++i)
      findings.push_back(to_finding(task.observations, suspects[*i], *trials[*i], is_alone));
    left.erase(left.begin(), end);
  }
  return alternatives;
}

TagFinding places_or_loose(const PartTask& task, const Part& part, const AdjustedPart& solved,
                           TagFinding loose) {
  std::vector<int> tags = solved.part.tags;
  const auto at = std::ranges::lower_bound(tags, loose.tag);
  if (at == tags.end() || *at != loose.tag) tags.insert(at, loose.tag);
  const TagNeighbourhoods neighbourhoods(task.observations, narrowed_to(task.observations, part, tags),
                                         kMostFramesTried);
  const Suspect suspect = to_suspect(task.observations, neighbourhoods, loose.tag);
  if (suspect.views.size() < kLeastViewsOfSuspect) return loose;
  const auto trial = FaultTrials(task, suspect, solved).best();
  const bool has_places =
      trial && (trial->kind == TagFinding::Kind::kMoved || trial->kind == TagFinding::Kind::kTwoPlaces);
  if (!has_places) return loose;
  TagFinding places = to_finding(task.observations, suspect, *trial, true);
  places.misfit_before = loose.misfit_before;
  places.misfit_after = 1.0;  // what is left is as usual, or it were no explanation
  places.num_views = loose.num_views;
  return places;
}

}  // namespace apriltrack
