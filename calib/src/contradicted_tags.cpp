#include "contradicted_tags.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "part_without.h"

namespace apriltrack {
namespace {

constexpr double kMostRejected = 0.5;

std::set<int> contradicted_tags(const Observations& observations, const Part& part, const Part& kept) {
  const std::map<int, int> offered = count_views(observations, narrowed_to(observations, part, kept.tags));
  std::set<int> contradicted;
  for (const auto& [tag, views] : count_views(observations, kept)) {
    if (offered.at(tag) - views > kMostRejected * offered.at(tag)) contradicted.insert(tag);
  }
  return contradicted;
}

}  // namespace

std::vector<int> leave_out_contradicted(const PartTask& task, const Part& part, AdjustedPart& solved) {
  std::set<int> contradicted = contradicted_tags(task.observations, part, solved.part);
  const auto h = static_cast<std::size_t>(solved.held_tag);
  if (task.options.held_tag == task.observations.tags[h]) contradicted.erase(solved.held_tag);
  if (contradicted.empty()) return {};
  std::set<int> gone = contradicted;
  std::ranges::set_difference(part.tags, solved.part.tags, std::inserter(gone, gone.end()));
  if (!adjust_without(task, part, gone, solved)) return {};
  return {contradicted.begin(), contradicted.end()};
}

}  // namespace apriltrack
