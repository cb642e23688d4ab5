#include "hypotheses/contradicted_tags.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "apriltrack/base/error.h"
#include "faults/part_without.h"

namespace apriltrack {
namespace {

constexpr double kMostRejected = 0.5;

/// The tag of which the greatest share of views, over a half, was lost.
std::optional<int> most_contradicted(const Observations& observations, const Part& offered,
                                     const Part& kept) {
  const std::map<int, int> views_kept = count_views(observations, kept);
  std::optional<int> worst;
  double most = kMostRejected;
  for (const auto& [tag, views] : count_views(observations, offered)) {
    const auto of_tag = views_kept.find(tag);
    const double share =
        1.0 - (of_tag == views_kept.end() ? 0.0 : of_tag->second) / static_cast<double>(views);
    if (share > most) {
      worst = tag;
      most = share;
    }
  }
  return worst;
}

/// The worst first, and without it the others: what was lost for want of a second tag that fits speaks
/// against that tag, and not against the one that was seen beside it. Ends at a tag that the user holds.
std::set<int> contradicted_tags(const PartTask& task, const Part& part, const Part& kept) {
  std::set<int> contradicted;
  std::vector<int> tags = kept.tags;
  while (true) {
    const auto worst = most_contradicted(task.observations, narrowed_to(task.observations, part, tags),
                                         narrowed_to(task.observations, kept, tags));
    if (!worst || is_held_by_wish(task, *worst)) return contradicted;
    contradicted.insert(*worst);
    std::erase(tags, *worst);
  }
}

}  // namespace

std::vector<int> leave_out_contradicted(const PartTask& task, const Part& part, AdjustedPart& solved) {
  const std::set<int> contradicted = contradicted_tags(task, part, solved.part);
  if (contradicted.empty()) return {};
  std::set<int> gone = contradicted;
  std::ranges::set_difference(part.tags, solved.part.tags, std::inserter(gone, gone.end()));
  if (!adjust_without(task, part, gone, solved)) return {};  // too little is left that agrees
  return {contradicted.begin(), contradicted.end()};
}

}  // namespace apriltrack
