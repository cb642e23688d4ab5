#include "hypotheses/undecided_tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "faults/part_without.h"
#include "initialise/mirror_test.h"

namespace apriltrack {
namespace {

int views_of(const std::map<int, int>& views, const std::vector<int>& tags) {
  int sum = 0;
  for (const int tag : tags) {
    if (const auto of_tag = views.find(tag); of_tag != views.end()) sum += of_tag->second;
  }
  return sum;
}

/// Of two sides of a joint that is open, the one with fewer views goes; where the user holds a tag of the
/// part, the side that has fewer tags.
std::set<int> tags_to_go(const PartTask& task, const AdjustedPart& solved, const ParallelFor& parallel) {
  const std::vector<std::vector<int>> groups = undecided_groups(task, solved.part, solved.state, parallel);
  const std::map<int, int> views = count_views(task.observations, solved.part);
  std::set<int> undecided;
  for (const std::vector<int>& group : groups) undecided.insert(group.begin(), group.end());
  if (is_held_by_wish(task, solved.held_tag) || groups.empty()) return undecided;
  const auto largest = std::ranges::max_element(
      groups, {}, [&](const std::vector<int>& group) { return views_of(views, group); });
  if (2 * views_of(views, *largest) <= views_of(views, solved.part.tags) || largest->size() < 2)
    return undecided;
  std::set<int> others;
  std::ranges::set_difference(solved.part.tags, *largest, std::inserter(others, others.end()));
  return others;
}

}  // namespace

std::optional<NoMap> leave_out_undecided(const PartTask& task, const Part& part, AdjustedPart& solved,
                                         const ParallelFor& parallel) {
  std::set<int> gone, open(solved.undecided.begin(), solved.undecided.end());
  std::ranges::set_difference(part.tags, solved.part.tags, std::inserter(gone, gone.end()));
  for (std::set<int> undecided = tags_to_go(task, solved, parallel); !undecided.empty();
       undecided = tags_to_go(task, solved, parallel)) {
    const TagKey& held = task.observations.tags[static_cast<std::size_t>(solved.held_tag)];
    if (undecided.contains(solved.held_tag) && is_held_by_wish(task, solved.held_tag))
      return NoMap{
          fmt::format("how {} lies to the other tags is open: its views agree with two poses about "
                      "equally well. Film it from further aside, together with others, or hold "
                      "another tag",
                      to_string(held))};
    gone.insert(undecided.begin(), undecided.end());
    open.insert(undecided.begin(), undecided.end());
    if (!adjust_without(task, part, gone, solved))
      return NoMap{
          "how the tags lie to each other is open: their views agree with two poses about equally "
          "well; film them from further aside, and nearer"};
  }
  solved.undecided.assign(open.begin(), open.end());
  return std::nullopt;
}

}  // namespace apriltrack
