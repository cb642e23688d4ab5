#include "rival_tags.h"

#include <algorithm>
#include <deque>
#include <map>
#include <set>

namespace apriltrack {
namespace {

/// Which tags are seen together: a graph of tags and frames.
class TagPaths {
 public:
  TagPaths(const Observations& observations, const Part& kept, int without) {
    for (const std::size_t v : kept.views) {
      const TagView& view = observations.views[v];
      if (view.tag == without) continue;
      tags_of_frame_[view.frame].insert(view.tag);
      frames_of_tag_[view.tag].insert(view.frame);
    }
  }

  /// The tags of a shortest path, ends included, that avoids one (-1: none); empty where there is none.
  std::vector<int> shortest(const std::set<int>& from, const std::set<int>& to, int avoided) const {
    std::map<int, int> before;
    std::deque<int> next;
    const auto reach = [&](int tag, int previous) {
      if (tag != avoided && before.try_emplace(tag, previous).second) next.push_back(tag);
    };
    for (const int tag : from) reach(tag, tag);
    for (; !next.empty(); next.pop_front()) {
      if (to.contains(next.front())) return path_to(next.front(), before);
      for (const int frame : frames_of_tag_.at(next.front())) {
        for (const int tag : tags_of_frame_.at(frame)) reach(tag, next.front());
      }
    }
    return {};
  }

 private:
  static std::vector<int> path_to(int tag, const std::map<int, int>& before) {
    std::vector<int> path{tag};
    for (; before.at(tag) != tag; tag = path.back()) path.push_back(before.at(tag));
    return path;
  }

  std::map<int, std::set<int>> tags_of_frame_, frames_of_tag_;
};

/// The others of the map that are seen in the frames of some views of a tag.
std::set<int> tags_beside(const Observations& observations, const Part& part,
                          const std::vector<std::size_t>& views, const std::vector<int>& tags_of_map) {
  std::set<int> frames, tags;
  for (const std::size_t v : views) frames.insert(observations.views[v].frame);
  for (const std::size_t v : part.views) {
    const TagView& view = observations.views[v];
    if (frames.contains(view.frame) && std::ranges::binary_search(tags_of_map, view.tag))
      tags.insert(view.tag);
  }
  return tags;
}

}  // namespace

std::vector<int> rival_tags(const Observations& observations, const Part& part, const Part& kept,
                            const TagFinding& finding) {
  std::vector<int> others = kept.tags;
  std::erase(others, finding.tag);
  const auto& [at_first, at_second] = finding.views_by_place;
  const std::set<int> first = tags_beside(observations, part, at_first, others);
  const std::set<int> second = tags_beside(observations, part, at_second, others);
  const TagPaths paths(observations, kept, finding.tag);
  std::vector<int> rivals = paths.shortest(first, second, -1);
  std::erase_if(rivals, [&](int tag) { return !paths.shortest(first, second, tag).empty(); });
  return rivals;
}

}  // namespace apriltrack
