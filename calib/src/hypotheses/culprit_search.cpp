#include "hypotheses/culprit_search.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "faults/part_without.h"
#include "faults/tag_suspects.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostTold = 6;  // tags, and pairs of them

/// The same without some tags; nullopt where nothing is left, where one is held by choice, and where what is
/// left contradicts itself.
std::optional<AdjustedPart> adjust_anew(const PartTask& task, const Part& part, const std::set<int>& gone,
                                        int held_tag) {
  const std::optional<HeldPart> rest = part_without(task, part, gone, held_tag);
  if (!rest) return std::nullopt;
  Outcome<AdjustedPart> result = adjust_part(task, rest->part, rest->held_tag, on_one_thread(task));
  // Contradictory, or not converged: so these tags are not the cause.
  if (!result || result->contradictions.are_there()) return std::nullopt;
  return std::move(*result);
}

struct Trial {
  int tag = 0;
  std::optional<AdjustedPart> rest;
  std::optional<TagFinding> finding;  ///< What is wrong with the tag that was left out.
  std::size_t accusations = 0;        ///< Of that tag.
  std::size_t num_others = 0;         ///< That still seem at fault.

  bool is_explained() const { return finding && finding->is_complete(); }
  /// That a tag has no fixed place explains anything, and nothing: it counts as a fault that is left.
  std::size_t num_unexplained() const {
    return num_others + (finding && finding->kind == TagFinding::Kind::kLoose ? 1 : 0);
  }
  bool is_copied() const { return finding && finding->may_be_copies; }
  std::size_t num_left() const { return rest ? rest->part.tags.size() : 0; }
};

/// A tag whose fault can be named from the map without it, that leaves few others at fault, the more wrong
/// the better; else one whose absence keeps many tags, and of such the one that is accused most.
std::tuple<bool, int, double, std::size_t, std::size_t> merit(const Trial& trial) {
  const bool is_explained = trial.is_explained();
  return {is_explained, is_explained ? -static_cast<int>(trial.num_unexplained()) : 0,
          is_explained ? trial.finding->gain() : 0.0, trial.num_left(), trial.rest ? trial.accusations : 0};
}

/// Where frames go from one place of an id to the other over a second tag, that one may as well be the copy.
/// What lies beyond hangs on few frames then, so that what they say need not be complete.
bool is_rival_copy(const Trial& trial, const Trial& best) {
  return trial.is_copied() && best.is_copied() && trial.num_unexplained() <= best.num_unexplained() &&
         trial.finding->gain() >= best.finding->gain();
}

/// All whose absence ends the contradictions, as good as the best: whose faults explain about as much; or,
/// where no fault has a name, that leave about as many tags.
std::set<int> possible_culprits(const std::vector<Trial>& trials, const Trial& best) {
  const std::size_t most = std::ranges::max(trials, {}, &Trial::num_left).num_left();
  std::set<int> tags;
  for (const Trial& trial : trials) {
    if (!trial.rest) continue;
    if (is_rival_copy(trial, best)) tags.insert(trial.tag);
    if (trial.is_explained() != best.is_explained()) continue;
    const bool is_as_good = best.is_explained() ? trial.num_unexplained() <= best.num_unexplained() &&
                                                      2.0 * trial.finding->gain() >= best.finding->gain()
                                                : 2 * trial.num_left() >= most;
    if (is_as_good) tags.insert(trial.tag);
  }
  return tags;
}

std::string name_of(const Observations& observations, int tag) {
  return to_string(observations.tags[static_cast<std::size_t>(tag)]);
}

std::string names_of(const Observations& observations, const std::vector<int>& tags) {
  std::string names;
  for (const int tag : tags) names += (names.empty() ? "" : ", ") + name_of(observations, tag);
  return names;
}

/// How often the contradictions name the tag, by itself or with another.
std::size_t count_accusations(const Contradictions& contradictions, int tag) {
  return static_cast<std::size_t>(std::ranges::count(contradictions.tags, tag) +
                                  std::ranges::count_if(contradictions.links, [&](const auto& link) {
                                    return link.first == tag || link.second == tag;
                                  }));
}

Trial try_without(const PartTask& task, const Part& part, const Contradictions& contradictions, int tag,
                  int held_tag) {
  Trial trial{tag, adjust_anew(task, part, {tag}, held_tag), std::nullopt,
              count_accusations(contradictions, tag)};
  if (!trial.rest) return trial;
  trial.finding = look_by(task, part, *trial.rest, tag).finding;
  if (trial.finding)
    trial.num_others = suspects_in(task, part, *trial.rest, {tag}, on_one_thread(task)).size();
  return trial;
}

/// Of several culprits, any of which may be at fault: what may be wrong with each.
std::vector<TagFinding> rival_findings(const std::vector<Trial>& trials, const std::set<int>& culprits) {
  std::vector<TagFinding> findings;
  for (const Trial& trial : trials) {
    if (!culprits.contains(trial.tag) || !trial.finding) continue;
    findings.push_back(*trial.finding);
    findings.back().blame = TagFinding::Blame::kThisOrAnother;
    findings.back().is_left_out = true;
  }
  return findings;
}

}  // namespace

std::vector<int> culprit_candidates(const Part& part, const Contradictions& contradictions) {
  constexpr std::size_t kMaxTrials = 40;
  if (part.tags.size() <= kMaxTrials) return part.tags;
  std::set<int> tags(contradictions.tags.begin(), contradictions.tags.end());
  for (const auto& [a, b] : contradictions.links) tags.insert({a, b});
  std::vector<int> some(tags.begin(), tags.end());
  std::ranges::stable_sort(some, std::greater<>(),
                           [&](int tag) { return count_accusations(contradictions, tag); });
  some.resize(std::min(some.size(), kMaxTrials));
  return some;
}

NoMap contradictory(const Observations& observations, const Contradictions& contradictions) {
  std::vector<std::string> all;
  for (const int tag : contradictions.tags) all.push_back(name_of(observations, tag));
  for (const auto& [a, b] : contradictions.links)
    all.push_back(fmt::format("{} with {}", name_of(observations, a), name_of(observations, b)));
  const std::size_t told = std::min(all.size(), kMostTold);
  const std::string what =
      fmt::format("{}{}", fmt::join(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(told), ", "),
                  all.size() > told ? fmt::format(" and {} more", all.size() - told) : "");
  return {
      fmt::format("{} of {} frames contradict the others, and no one tag is clearly the cause; "
                  "most contradicted: {}. Does an id hang in two places? {}",
                  contradictions.contradicting, contradictions.frames, what, kWhatToCheck)};
}

std::optional<AdjustedPart> adjust_without_culprit(const PartTask& task, const Part& part,
                                                   const Contradictions& contradictions, int held_tag,
                                                   const ParallelFor& parallel, const LogSink& log) {
  if (part.tags.size() < 3) return std::nullopt;
  const std::vector<int> tags = culprit_candidates(part, contradictions);
  std::vector<Trial> trials(tags.size());
  parallel(tags.size(),
           [&](std::size_t i) { trials[i] = try_without(task, part, contradictions, tags[i], held_tag); });
  const auto best = std::ranges::max_element(trials, {}, merit);
  const bool needs_a_name = 2 * contradictions.contradicting > contradictions.frames;  // most frames disagree
  if (best == trials.end() || !best->rest || (needs_a_name && !best->is_explained())) return std::nullopt;
  const std::set<int> culprits = possible_culprits(trials, *best);
  std::optional<AdjustedPart> result =
      culprits.size() == 1 ? std::move(best->rest) : adjust_anew(task, part, culprits, held_tag);
  if (!result) return std::nullopt;
  result->culprits.assign(culprits.begin(), culprits.end());
  if (culprits.size() > 1) result->rivals = rival_findings(trials, culprits);
  const std::string why = contradictions.frames == 0
                              ? "the map cannot be adjusted"
                              : fmt::format("{} of {} frames contradict each other",
                                            contradictions.contradicting, contradictions.frames);
  log(LogLevel::kInfo, fmt::format("left out: {}: with {}, {}", names_of(task.observations, result->culprits),
                                   culprits.size() == 1 ? "it" : "them", why));
  return result;
}

}  // namespace apriltrack
