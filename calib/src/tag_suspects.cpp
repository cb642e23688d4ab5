#include "tag_suspects.h"

#include <algorithm>
#include <map>
#include <utility>

#include "part_without.h"

namespace apriltrack {
namespace {

constexpr double kSuspicious = 2.5;
constexpr double kManyRejected = 1.0 / 3.0;  // of a tag's views

/// Tags of the map of which many views were rejected.
std::set<int> tags_rejected_often(const Observations& observations, const Part& part,
                                  const AdjustedPart& solved) {
  const std::map<int, int> offered =
      count_views(observations, narrowed_to(observations, part, solved.part.tags));
  std::set<int> tags;
  for (const auto& [tag, kept] : count_views(observations, solved.part)) {
    if (offered.at(tag) - kept > kManyRejected * offered.at(tag)) tags.insert(tag);
  }
  return tags;
}

}  // namespace

TagLook look_by(const PartTask& task, const Part& part, const AdjustedPart& solved, int tag) {
  return look_at(task, solved, probe_views(task, part, solved, tag), tag);
}

std::vector<int> suspects_in(const PartTask& task, const Part& part, const AdjustedPart& solved,
                             const std::set<int>& known, const ParallelFor& parallel) {
  const std::set<int> rejected = tags_rejected_often(task.observations, part, solved);
  std::vector<TagLook> looks(part.tags.size());
  parallel(looks.size(), [&](std::size_t i) {
    if (!known.contains(part.tags[i])) looks[i] = look_by(task, part, solved, part.tags[i]);
  });
  std::vector<std::pair<double, int>> suspects;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const TagLook& look = looks[i];
    if (known.contains(part.tags[i])) continue;
    if (look.misfit > kSuspicious || look.finding || rejected.contains(part.tags[i]))
      suspects.emplace_back(-look.misfit, part.tags[i]);
  }
  std::ranges::sort(suspects);
  std::vector<int> tags;
  for (const auto& [misfit, tag] : suspects) tags.push_back(tag);
  return tags;
}

}  // namespace apriltrack
