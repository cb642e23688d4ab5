#include "lost_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "calibration_words.h"
#include "rival_tags.h"
#include "tag_paths.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostLinksTold = 6;

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

std::string words_of_link(const Observations& observations, const Link& link, int frames,
                          const std::vector<int>& joints) {
  const std::vector<TagKey> ends = keys_of(observations, {link.first, link.second});
  return fmt::format(
      "{0} and {1} are seen together in {2} {3}, which the map does not fit; it joins them by way of {4} "
      "alone. If {5} right, one of them hangs twice or was moved, and the map is folded there. Film {0} and "
      "{1} together again",
      to_string(ends[0]), to_string(ends[1]), frames, frames == 1 ? "frame only" : "frames only",
      list_tags(keys_of(observations, joints)), frames == 1 ? "that is" : "these are");
}

}  // namespace

std::vector<std::string> words_of_lost_links(const Observations& observations, const Part& offered,
                                             const Part& kept) {
  const TagPaths paths(observations, kept);
  const Links fitting = count_links(observations, kept);
  std::set<std::pair<std::set<int>, std::set<int>>> told;  // of two boards one link is
  std::vector<std::string> words;
  for (const auto& [link, frames] : count_links(observations, offered)) {
    if (fitting.contains(link) || words.size() == kMostLinksTold) continue;
    const std::vector<int> joints = tags_of_joints(paths, link);
    if (joints.empty()) continue;
    // As copies: minmax() returns references, here to temporaries.
    const std::pair<std::set<int>, std::set<int>> boards =
        std::minmax(paths.board_of(link.first), paths.board_of(link.second));
    if (!told.insert(boards).second) continue;
    words.push_back(words_of_link(observations, link, frames, joints));
  }
  return words;
}

}  // namespace apriltrack
