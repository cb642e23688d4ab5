#include "lost_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "calibration_words.h"
#include "rival_tags.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostLinksTold = 6;

using Link = std::pair<int, int>;

/// In how many frames of these views each two tags are seen together.
std::map<Link, int> count_links(const Observations& observations, const Part& part) {
  std::map<int, std::set<int>> frames;
  for (const std::size_t v : part.views)
    frames[observations.views[v].frame].insert(observations.views[v].tag);
  std::map<Link, int> links;
  for (const auto& [frame, tags] : frames) {
    for (auto a = tags.begin(); a != tags.end(); ++a)
      for (auto b = std::next(a); b != tags.end(); ++b) ++links[{*a, *b}];
  }
  return links;
}

std::string words_of_link(const Observations& observations, const Link& link, int frames,
                          const std::vector<int>& joints) {
  const std::vector<TagKey> ends = keys_of(observations, {link.first, link.second});
  return fmt::format(
      "{0} and {1} are seen together in {2} {3}, which the map does not fit; it joins them by way of {4} "
      "alone. If {5} "
      "right, one of them hangs twice or was moved, and the map is folded there. Film {0} and {1} together "
      "again",
      to_string(ends[0]), to_string(ends[1]), frames, frames == 1 ? "frame only" : "frames only",
      list_tags(keys_of(observations, joints)), frames == 1 ? "that is" : "these are");
}

}  // namespace

std::vector<std::string> words_of_lost_links(const Observations& observations, const Part& offered,
                                             const Part& kept) {
  const std::map<Link, int> fitting = count_links(observations, kept);
  std::vector<std::string> words;
  for (const auto& [link, frames] : count_links(observations, offered)) {
    if (fitting.contains(link) || words.size() == kMostLinksTold) continue;
    std::vector<int> joints = joints_between(observations, kept, {link.first}, {link.second});
    std::erase_if(joints, [&](int tag) { return tag == link.first || tag == link.second; });
    if (!joints.empty()) words.push_back(words_of_link(observations, link, frames, joints));
  }
  return words;
}

}  // namespace apriltrack
