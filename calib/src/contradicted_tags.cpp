#include "contradicted_tags.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "undecided_tags.h"

namespace apriltrack {
namespace {

constexpr double kMostRejected = 0.5;

std::map<int, int> views_by_tag(const Observations& observations, const Part& part) {
  std::map<int, int> count;
  for (const std::size_t v : part.views) ++count[observations.views[v].tag];
  return count;
}

std::set<int> contradicted_tags(const Observations& observations, const Part& part, const Part& kept) {
  const std::map<int, int> offered = views_by_tag(observations, part);
  std::set<int> contradicted;
  for (const auto& [tag, views] : views_by_tag(observations, kept)) {
    if (offered.at(tag) - views > kMostRejected * offered.at(tag)) contradicted.insert(tag);
  }
  return contradicted;
}

}  // namespace

std::vector<int> leave_out_contradicted(const PartTask& task, const Part& part, AdjustedPart& solved) {
  std::set<int> contradicted = contradicted_tags(task.observations, part, solved.part);
  if (!contradicted.empty() && !hold_another(task, contradicted, solved)) contradicted.erase(solved.held_tag);
  if (contradicted.empty()) return {};
  std::set<int> gone = contradicted;
  std::ranges::set_difference(part.tags, solved.part.tags, std::inserter(gone, gone.end()));
  if (!adjust_without(task, part, gone, solved)) return {};
  return {contradicted.begin(), contradicted.end()};
}

}  // namespace apriltrack
