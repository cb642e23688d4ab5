#include "observations/tags_that_hang_together.h"

#include <algorithm>
#include <map>
#include <set>

namespace apriltrack {
namespace {

/// Until none is alone any more. False where nothing went.
bool drop_lone_ones(const std::vector<TagAtMoment>& seen, std::vector<bool>& is_in) {
  std::map<int, std::set<int>> moments_of_tag, tags_of_moment;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!is_in[i]) continue;
    moments_of_tag[seen[i].tag].insert(seen[i].moment);
    tags_of_moment[seen[i].moment].insert(seen[i].tag);
  }
  bool has_dropped = false;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!is_in[i] || (moments_of_tag[seen[i].tag].size() >= 2 && tags_of_moment[seen[i].moment].size() >= 2))
      continue;
    is_in[i] = false;
    has_dropped = true;
  }
  return has_dropped;
}

/// A tag of the part that each tag is in.
class TagJoins {
 public:
  int of(int tag) {
    const auto parent = parents_.try_emplace(tag, tag).first;
    if (parent->second != tag) parent->second = of(parent->second);
    return parents_.at(tag);
  }
  void join(int a, int b) { parents_[of(a)] = of(b); }

 private:
  std::map<int, int> parents_;
};

/// The smallest of several; -1 of none.
int most_frequent(const std::map<int, int>& counts) {
  const auto most = std::ranges::max_element(
      counts, {}, [](const auto& number_and_count) { return number_and_count.second; });
  return most == counts.end() ? -1 : most->first;
}

}  // namespace

HangingTogether tags_that_hang_together(const std::vector<TagAtMoment>& seen, int wanted_tag) {
  HangingTogether result{std::vector<bool>(seen.size(), true), -1};
  while (drop_lone_ones(seen, result.is_in)) {
  }
  TagJoins parts;
  std::map<int, int> tag_of_moment;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (result.is_in[i])
      parts.join(seen[i].tag, tag_of_moment.try_emplace(seen[i].moment, seen[i].tag).first->second);
  }
  std::map<int, int> counts_of_parts, counts_of_tags;
  bool has_wanted = false;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!result.is_in[i]) continue;
    ++counts_of_parts[parts.of(seen[i].tag)];
    has_wanted = has_wanted || seen[i].tag == wanted_tag;
  }
  if (counts_of_parts.empty()) return result;
  const int part = has_wanted ? parts.of(wanted_tag) : most_frequent(counts_of_parts);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    result.is_in[i] = result.is_in[i] && parts.of(seen[i].tag) == part;
    if (result.is_in[i]) ++counts_of_tags[seen[i].tag];
  }
  result.held_tag = has_wanted ? wanted_tag : most_frequent(counts_of_tags);
  return result;
}

}  // namespace apriltrack
