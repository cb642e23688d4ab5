#include "culprit_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "apriltrack/base/error.h"
#include "part_without.h"
#include "tag_fault.h"

namespace apriltrack {
namespace {

/// The same without one tag; nullopt where nothing is left, where it is held by choice, and where what is
/// left contradicts itself.
std::optional<AdjustedPart> adjust_anew(const PartTask& task, const Part& part, int tag, int held_tag) {
  const std::optional<HeldPart> rest = part_without(task, part, {tag}, held_tag);
  if (!rest) return std::nullopt;
  try {
    AdjustedPart result = adjust_part(task, rest->part, rest->held_tag, parallel_for(1));
    if (result.contradictions.are_there()) return std::nullopt;
    return result;
  } catch (const Error&) {  // contradictory, or not converged: so this tag is not the cause
    return std::nullopt;
  }
}

struct Trial {
  std::optional<AdjustedPart> rest;
  std::optional<TagFinding> finding;  ///< What is wrong with the tag that was left out.
  std::size_t accusations = 0;        ///< Of that tag.

  bool is_explained() const { return finding && finding->is_complete(); }
};

/// A tag whose fault can be named from the map without it, the more wrong the better; else one whose absence
/// keeps many tags, and of such the one that is accused most.
std::tuple<bool, double, std::size_t, std::size_t> merit(const Trial& trial) {
  return {trial.is_explained(), trial.is_explained() ? trial.finding->gain() : 0.0,
          trial.rest ? trial.rest->part.tags.size() : 0, trial.rest ? trial.accusations : 0};
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
  Trial trial{adjust_anew(task, part, tag, held_tag), std::nullopt, count_accusations(contradictions, tag)};
  if (trial.rest) trial.finding = look_at(task, probe_views(task, part, *trial.rest, tag), tag).finding;
  return trial;
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
  const std::vector<int> tags = culprit_candidates(part, contradictions);
  std::vector<Trial> trials(tags.size());
  parallel(tags.size(),
           [&](std::size_t i) { trials[i] = try_without(task, part, contradictions, tags[i], held_tag); });
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
