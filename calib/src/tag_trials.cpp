#include "tag_trials.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "fault_trials.h"
#include "tag_fault_words.h"
#include "tag_neighbourhoods.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostSuspects = 8;
constexpr std::size_t kLeastGivenUp = 3, kLeastViews = 4;
constexpr std::size_t kMostFramesTried = 120;  // of a tag; and as many others
constexpr double kSureFrames = 0.7;       // of a tag's, which show two others that agree
constexpr double kOneView = 100.0;        // of half the squares: more than chance gives up
constexpr double kAsGood = 0.5;           // of the gain, where that is small

/// Tags by how many of their views were given up, most first.
std::vector<int> tags_given_up(const PartTask& task, const Part& part, const AdjustedPart& solved) {
  std::map<int, std::size_t> given_up;
  for (const std::size_t v : part.views) {
    if (!std::ranges::binary_search(solved.part.views, v)) ++given_up[task.observations.views[v].tag];
  }
  std::erase_if(given_up, [](const auto& one) { return one.second < kLeastGivenUp; });
  std::vector<int> tags;
  for (const auto& [tag, views] : given_up) tags.push_back(tag);
  std::ranges::stable_sort(tags, std::greater<>(), [&](int tag) { return given_up[tag]; });
  tags.resize(std::min(tags.size(), kMostSuspects));
  return tags;
}

Suspect to_suspect(const Observations& observations, const TagNeighbourhoods& neighbourhoods,
                   int tag) {
  Suspect suspect{tag, neighbourhoods.around(tag), {}};
  std::ranges::copy_if(suspect.part.views, std::back_inserter(suspect.views),
                       [&](std::size_t v) { return observations.views[v].tag == tag; });
  return suspect;
}

std::vector<Suspect> find_suspects(const PartTask& task, const Part& part, const AdjustedPart& solved) {
  std::vector<int> suspected = tags_given_up(task, part, solved), others = part.tags;
  const auto is_explained_already = [&](int tag) { return is_explained_beyond_doubt(task, part, solved, tag); };
  std::set<int> explained;
  std::ranges::copy_if(suspected, std::inserter(explained, explained.end()), is_explained_already);
  std::erase_if(suspected, [&](int tag) { return explained.contains(tag); });
  std::vector<Suspect> suspects;
  if (suspected.empty()) return suspects;
  std::erase_if(others, [&](int tag) { return explained.contains(tag); });
  const TagNeighbourhoods neighbourhoods(task.observations, narrowed_to(task.observations, part, others),
                                         kMostFramesTried);
  for (const int tag : suspected) {
    Suspect suspect = to_suspect(task.observations, neighbourhoods, tag);
    if (suspect.views.size() >= kLeastViews) suspects.push_back(std::move(suspect));
  }
  return suspects;
}

std::string words_of_places(const Observations& observations, const Suspect& suspect, const FaultTrial& trial,
                            const std::string& name) {
  TwoPlaces two{};
  two.fit.T_map_tag = trial.T_map_first;
  two.second.T_map_tag = trial.T_map_second;
  two.is_at_second = trial.is_at_second;
  if (trial.kind == TagFinding::Kind::kTwoPlaces) return words_of_copies(two, name);
  std::vector<ProbeView> when;
  for (const std::size_t v : suspect.views) {
    ProbeView& probe = when.emplace_back();
    probe.view = &observations.views[v];
    probe.timestamp = observations.frames[static_cast<std::size_t>(probe.view->frame)];
  }
  return words_of_move(two, when, observations.frames.front(), name);
}

std::string words_of(const Observations& observations, const Suspect& suspect, const FaultTrial& trial) {
  const auto t = static_cast<std::size_t>(suspect.tag);
  const std::string name = to_string(observations.tags[t]);
  if (trial.kind != TagFinding::Kind::kSize) return words_of_places(observations, suspect, trial, name);
  TagFit fit;
  fit.shape.size_m = observations.sizes_m[t];
  fit.shape.log_scale = trial.log_scale;
  fit.scale_sigma = trial.scale_sigma;
  return words_of_size(fit, name);
}

TagFinding to_finding(const Observations& observations, const Suspect& suspect, const FaultTrial& trial,
                      bool is_alone) {
  TagFinding finding;
  finding.tag = suspect.tag;
  finding.kind = trial.kind;
  finding.is_left_out = true;
  finding.num_views = suspect.views.size();
  finding.words = words_of(observations, suspect, trial);
  if (!is_alone) finding.words += ". Or another tag is at fault: the views do not tell which";
  return finding;
}

}  // namespace

bool is_explained_beyond_doubt(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag) {
  const std::vector<ProbeView> probes = probe_views(task, part, solved, tag);
  const auto sure = std::ranges::count_if(probes, &ProbeView::is_frame_sure);
  if (static_cast<double>(sure) < kSureFrames * static_cast<double>(probes.size())) return false;
  const TagLook look = look_at(task, probes, tag);
  return look.finding && look.finding->is_complete();
}

std::vector<TagFinding> find_faults_by_trial(const PartTask& task, const Part& part,
                                             const AdjustedPart& solved, const ParallelFor& parallel) {
  const std::vector<Suspect> suspects = find_suspects(task, part, solved);
  std::vector<std::optional<FaultTrial>> trials(suspects.size());
  parallel(suspects.size(), [&](std::size_t i) { trials[i] = FaultTrials(task, suspects[i], solved).best(); });
  double most = 0.0;
  for (const auto& trial : trials) most = std::max(most, trial ? trial->gain : 0.0);
  const auto is_as_good = [&](const auto& trial) {
    return trial && trial->gain > most - std::min(kOneView, kAsGood * most);
  };
  const bool is_alone = std::ranges::count_if(trials, is_as_good) == 1;
  std::vector<TagFinding> findings;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (is_as_good(trials[i]))
      findings.push_back(to_finding(task.observations, suspects[i], *trials[i], is_alone));
  }
  return findings;
}

}  // namespace apriltrack
