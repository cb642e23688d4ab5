#include "undecided_tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apriltrack/base/error.h"
#include "mirror_test.h"

namespace apriltrack {
namespace {

constexpr int kMaxRoundsOfDoubt = 4;

}  // namespace

bool hold_another(const PartTask& task, const std::set<int>& go, AdjustedPart& solved) {
  if (!go.contains(solved.held_tag)) return true;
  const TagKey& held = task.observations.tags[static_cast<std::size_t>(solved.held_tag)];
  const auto other = std::ranges::find_if(solved.part.tags, [&](int tag) { return !go.contains(tag); });
  if (other == solved.part.tags.end() || (task.options.held_tag && *task.options.held_tag == held))
    return false;
  solved.held_tag = *other;
  move_origin_to(solved.state, *other);
  return true;
}

bool adjust_without(const PartTask& task, const Part& part, const std::set<int>& gone, AdjustedPart& solved) {
  std::vector<std::size_t> views = part.views;
  std::erase_if(views, [&](std::size_t v) { return gone.contains(task.observations.views[v].tag); });
  const Part rest = connected_to(task.observations, views, solved.held_tag, task.options.min_views);
  if (rest.tags.size() < 2) return false;
  solved.part = adjust_cleanly(task, rest, solved.held_tag, solved.state);
  return true;
}

void leave_out_undecided(const PartTask& task, const Part& part, AdjustedPart& solved) {
  std::set<int> gone;
  for (int round = 0; round < kMaxRoundsOfDoubt; ++round) {
    std::set<int> undecided;
    for (const std::vector<int>& group : undecided_groups(task.observations, solved.part, solved.state))
      undecided.insert(group.begin(), group.end());
    if (undecided.empty()) break;
    if (!hold_another(task, undecided, solved))
      throw no_result(
          "calibrate",
          fmt::format("how {} lies to the other tags is open: its views agree with two poses about "
                      "equally well. Film it from further aside, together with others, or hold "
                      "another tag (--held-tag)",
                      to_string(task.observations.tags[static_cast<std::size_t>(solved.held_tag)])));
    gone.insert(undecided.begin(), undecided.end());
    if (!adjust_without(task, part, gone, solved))
      throw no_result(
          "calibrate",
          "how the tags lie to each other is open: their views agree with two poses about equally "
          "well; film them from further aside, and nearer");
  }
  solved.undecided.assign(gone.begin(), gone.end());
}

}  // namespace apriltrack
