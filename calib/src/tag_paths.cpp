#include "tag_paths.h"

#include <deque>
#include <utility>

namespace apriltrack {
namespace {

std::vector<int> path_to(int tag, const std::map<int, int>& before) {
  std::vector<int> path{tag};
  for (; before.at(tag) != tag; tag = path.back()) path.push_back(before.at(tag));
  return path;
}

}  // namespace

TagPaths::TagPaths(const Observations& observations, const Part& ties) {
  for (const std::size_t v : ties.views) {
    const TagView& view = observations.views[v];
    tags_of_frame_[view.frame].insert(view.tag);
    frames_of_tag_[view.tag].insert(view.frame);
  }
}

std::vector<int> TagPaths::shortest(const std::set<int>& from, const std::set<int>& to, int avoided) const {
  std::map<int, int> before;
  std::set<int> frames_seen;
  std::deque<int> next;
  const auto reach = [&](int tag, int previous) {
    if (tag != avoided && before.try_emplace(tag, previous).second) next.push_back(tag);
  };
  for (const int tag : from) reach(tag, tag);
  for (; !next.empty(); next.pop_front()) {
    if (to.contains(next.front())) return path_to(next.front(), before);
    const auto frames = frames_of_tag_.find(next.front());
    if (frames == frames_of_tag_.end()) continue;
    for (const int frame : frames->second) {
      if (!frames_seen.insert(frame).second) continue;
      for (const int tag : tags_of_frame_.at(frame)) reach(tag, next.front());
    }
  }
  return {};
}

bool TagPaths::does_join_alone(int tag) const {
  const auto frames = frames_of_tag_.find(tag);
  if (frames == frames_of_tag_.end()) return false;
  std::set<int> beside;
  for (const int frame : frames->second) {
    const std::set<int>& tags = tags_of_frame_.at(frame);
    beside.insert(tags.begin(), tags.end());
  }
  beside.erase(tag);
  while (beside.size() > 1) {  // the last one reached is one end of the next path
    const int first = *beside.begin();
    beside.erase(beside.begin());
    if (shortest({first}, {*beside.begin()}, tag).empty()) return true;
  }
  return false;
}

}  // namespace apriltrack
