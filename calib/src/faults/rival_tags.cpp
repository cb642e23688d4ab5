#include "faults/rival_tags.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace apriltrack {
namespace {

/// The frames that show the tag at its one place and at its other. Of views that were not looked at those
/// count that lie between two of one place.
std::array<std::set<int>, 2> frames_by_place(const Observations& observations, const Part& part,
                                             const TagFinding& finding) {
  std::map<std::size_t, std::size_t> place_of_view;
  for (const std::size_t place : {0u, 1u})
    for (const std::size_t v : finding.views_by_place[place]) place_of_view.emplace(v, place);
  std::array<std::set<int>, 2> frames;
  for (const std::size_t v : part.views) {
    if (observations.views[v].tag != finding.tag) continue;
    const auto after = place_of_view.lower_bound(v);
    const auto before = after == place_of_view.begin() ? after : std::prev(after);
    const auto& [seen, place] = after == place_of_view.end() ? *before : *after;
    if (seen == v || after == place_of_view.end() || before->second == place)
      frames[place].insert(observations.views[v].frame);
  }
  return frames;
}

/// The others of the map that are seen in some frames.
std::set<int> tags_beside(const Observations& observations, const Part& part, const std::set<int>& frames,
                          const std::vector<int>& tags_of_map) {
  std::set<int> tags;
  for (const std::size_t v : part.views) {
    const TagView& view = observations.views[v];
    if (frames.contains(view.frame) && std::ranges::binary_search(tags_of_map, view.tag))
      tags.insert(view.tag);
  }
  return tags;
}

}  // namespace

std::vector<std::set<int>> joints_between(const TagPaths& paths, const std::set<int>& from,
                                          const std::set<int>& to) {
  std::vector<std::set<int>> joints;
  for (const int tag : paths.shortest(from, to, {})) {
    std::set<int> joint = paths.joint_at(tag, from, to);
    if (!joint.empty() && std::ranges::find(joints, joint) == joints.end())
      joints.push_back(std::move(joint));
  }
  const std::vector<std::set<int>> all = joints;
  std::erase_if(joints, [&](const std::set<int>& joint) {
    return std::ranges::any_of(all, [&](const std::set<int>& other) {
      return other != joint && std::ranges::includes(joint, other);
    });
  });
  return joints;
}

std::vector<std::set<int>> rival_tags(const Observations& observations, const Part& part, const Part& ties,
                                      const TagFinding& finding) {
  if (finding.views_by_place[0].empty() || finding.views_by_place[1].empty()) return {};
  Part others = ties;
  std::erase(others.tags, finding.tag);
  std::erase_if(others.views, [&](std::size_t v) { return observations.views[v].tag == finding.tag; });
  const auto [at_first, at_second] = frames_by_place(observations, part, finding);
  return joints_between(TagPaths(observations, others),
                        tags_beside(observations, part, at_first, others.tags),
                        tags_beside(observations, part, at_second, others.tags));
}

}  // namespace apriltrack
