#include "faults/lost_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "faults/rival_tags.h"
#include "observations/tag_paths.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostLinks = 6;

using Link = std::pair<int, int>;

using Links = std::map<Link, int>;

/// In how many frames of these views each two tags are seen together.
Links count_links(const Observations& observations, const Part& part) {
  std::map<int, std::set<int>> frames;
  for (const std::size_t v : part.views)
    frames[observations.views[v].frame].insert(observations.views[v].tag);
  Links links;
  for (const auto& [frame, tags] : frames) {
    for (auto a = tags.begin(); a != tags.end(); ++a)
      for (auto b = std::next(a); b != tags.end(); ++b) ++links[{*a, *b}];
  }
  return links;
}

/// The tags of all that alone join the two, themselves and their boards apart.
std::vector<int> tags_of_joints(const TagPaths& paths, const Link& link) {
  std::set<int> tags;
  for (const std::set<int>& joint : joints_between(paths, {link.first}, {link.second}))
    if (!joint.contains(link.first) && !joint.contains(link.second)) tags.insert(joint.begin(), joint.end());
  return {tags.begin(), tags.end()};
}

}  // namespace

std::vector<LostLink> find_lost_links(const Observations& observations, const Part& offered,
                                      const Part& kept) {
  const TagPaths paths(observations, kept);
  const Links fitting = count_links(observations, kept);
  std::set<std::pair<std::set<int>, std::set<int>>> known;  // of two boards one link is enough
  std::vector<LostLink> lost;
  for (const auto& [link, frames] : count_links(observations, offered)) {
    if (fitting.contains(link) || lost.size() == kMostLinks) continue;
    std::vector<int> joints = tags_of_joints(paths, link);
    if (joints.empty()) continue;
    // As copies: minmax() returns references, here to temporaries.
    const std::pair<std::set<int>, std::set<int>> boards =
        std::minmax(paths.board_of(link.first), paths.board_of(link.second));
    if (!known.insert(boards).second) continue;
    lost.push_back({link.first, link.second, frames, std::move(joints)});
  }
  return lost;
}

}  // namespace apriltrack
