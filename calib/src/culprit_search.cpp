#include "culprit_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "apriltrack/base/error.h"
#include "tag_fault.h"

namespace apriltrack {
namespace {

/// The same without one tag; nullopt where nothing is left, where it is held by choice, and where what is
/// left contradicts itself.
std::optional<AdjustedPart> adjust_without(const PartTask& task, const Part& part, int tag, int held_tag) {
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
    AdjustedPart result =
        adjust_part(task, rest, tag == held_tag ? rest.tags.front() : held_tag, parallel_for(1));
    if (result.contradictions.are_there()) return std::nullopt;
    return result;
  } catch (const Error&) {  // contradictory, or not converged: so this tag is not the cause
    return std::nullopt;
  }
}

struct Trial {
  std::optional<AdjustedPart> rest;
  std::optional<TagFinding> finding;  ///< What is wrong with the tag that was left out.

  bool is_explained() const { return finding && finding->is_complete(); }
};

/// A tag whose fault can be named from the map without it, the more wrong the better; else one whose absence
/// keeps many tags.
std::tuple<bool, double, std::size_t> merit(const Trial& trial) {
  return {trial.is_explained(), trial.is_explained() ? trial.finding->gain() : 0.0,
          trial.rest ? trial.rest->part.tags.size() : 0};
}

Trial try_without(const PartTask& task, const Part& part, int tag, int held_tag) {
  Trial trial{adjust_without(task, part, tag, held_tag), std::nullopt};
  if (trial.rest) trial.finding = look_at(task, probe_views(task, part, *trial.rest, tag), tag).finding;
  return trial;
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

}  // namespace

void fail_with_contradictions(const Observations& observations, const Contradictions& contradictions) {
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

std::optional<AdjustedPart> adjust_without_culprit(const PartTask& task, const Part& part,
                                                   const Contradictions& contradictions, int held_tag,
                                                   const ParallelFor& parallel, const LogSink& log) {
  if (part.tags.size() < 3) return std::nullopt;
  const std::vector<int> tags = suspects(part, contradictions);
  std::vector<Trial> trials(tags.size());
  parallel(tags.size(), [&](std::size_t i) { trials[i] = try_without(task, part, tags[i], held_tag); });
  const auto best = std::ranges::max_element(trials, {}, merit);
  const bool needs_a_name = 2 * contradictions.contradicting > contradictions.frames;  // most frames disagree
  if (best == trials.end() || !best->rest || (needs_a_name && !best->is_explained()) ||
      std::ranges::count(trials, merit(*best), merit) != 1)
    return std::nullopt;
  const int culprit = tags[static_cast<std::size_t>(best - trials.begin())];
  log(LogLevel::kInfo, fmt::format("{} is left out: with it, {} of {} frames contradict each other",
                                   to_string(task.observations.tags[static_cast<std::size_t>(culprit)]),
                                   contradictions.contradicting, contradictions.frames));
  AdjustedPart result = std::move(*best->rest);
  result.culprit = culprit;
  return result;
}

}  // namespace apriltrack
