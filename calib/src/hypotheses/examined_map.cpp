#include "hypotheses/examined_map.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace apriltrack {
namespace {

/// What of the part may be in the map, but for some tags.
Part part_of(const PartTask& task, const Part& part, const AdjustedPart& solved, std::set<int> gone) {
  gone.merge(tags_left_out(solved));
  return with_poses(task,
                    connected_to(task.observations, views_without(task.observations, part, gone),
                                 solved.held_tag, task.options.min_views),
                    solved.held_tag);
}

std::vector<TagHypothesis> score_tags(const PartTask& task, const RobustMap& map, const NullScale& scale,
                                      const ParallelFor& parallel) {
  std::vector<std::optional<TagHypothesis>> of_tags(map.part.tags.size());
  parallel(of_tags.size(),
           [&](std::size_t i) { of_tags[i] = likeliest_fault(task, map, scale, map.part.tags[i]); });
  std::vector<TagHypothesis> result;
  for (std::optional<TagHypothesis>& one : of_tags)
    if (one) result.push_back(std::move(*one));
  std::ranges::stable_sort(result, std::greater<>(), &TagHypothesis::log_odds);
  return result;
}

}  // namespace

double ExaminedMap::worst_log_odds() const {
  return faults.empty() ? -std::numeric_limits<double>::infinity() : faults.front().log_odds();
}

std::unique_ptr<ExaminedMap> examine(const PartTask& task, const Part& part, AdjustedPart solved,
                                     const std::set<int>& without, const ParallelFor& parallel) {
  const int held_tag = solved.held_tag;
  auto result = std::unique_ptr<ExaminedMap>(
      new ExaminedMap{solved, {task, part_of(task, part, solved, without), held_tag, solved.state}});
  if (!result->robust.poses) return nullptr;
  result->scale = null_scale(task, result->robust, parallel);
  result->faults = score_tags(task, result->robust, {result->scale.of_most}, parallel);
  result->contradictions = contradictions_of(task, result->robust.part, result->robust.state);
  return result;
}

}  // namespace apriltrack
