#include "observations/tag_paths.h"

#include <algorithm>
#include <deque>
#include <utility>

namespace apriltrack {
namespace {

// Of the frames that show either of two tags: those that show both, where the two may be on one board.
constexpr double kAlwaysTogether = 0.8;
constexpr std::size_t kLeastTogether = 3;  // frames: fewer show two tags together by chance

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

std::vector<int> TagPaths::shortest(const std::set<int>& from, const std::set<int>& to,
                                    const std::set<int>& avoided) const {
  std::map<int, int> before;
  std::set<int> frames_seen;
  std::deque<int> next;
  const auto reach = [&](int tag, int previous) {
    if (!avoided.contains(tag) && before.try_emplace(tag, previous).second) next.push_back(tag);
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

std::set<int> TagPaths::board_of(int tag) const {
  std::set<int> board{tag};
  for (const int other : beside(tag)) {
    const std::size_t both = num_joint_frames(tag, other);
    const std::size_t either = frames_of_tag_.at(tag).size() + frames_of_tag_.at(other).size() - both;
    if (both >= kLeastTogether && static_cast<double>(both) >= kAlwaysTogether * static_cast<double>(either))
      board.insert(other);
  }
  return 2 * board.size() > frames_of_tag_.size() ? std::set<int>{tag} : board;
}

std::set<int> TagPaths::joint_at(int tag, const std::set<int>& from, const std::set<int>& to) const {
  for (const std::set<int>& joint : {std::set<int>{tag}, board_of(tag)})
    if (shortest(from, to, joint).empty()) return joint;
  return {};
}

bool TagPaths::do_part_without(const std::set<int>& tags) const {
  std::set<int> others;
  for (const int tag : tags) others.merge(beside(tag));
  std::erase_if(others, [&](int other) { return tags.contains(other); });
  while (others.size() > 1) {  // the last one reached is one end of the next path
    const int first = *others.begin();
    others.erase(others.begin());
    if (shortest({first}, {*others.begin()}, tags).empty()) return true;
  }
  return false;
}

std::set<int> TagPaths::joint_at(int tag) const {
  for (const std::set<int>& joint : {std::set<int>{tag}, board_of(tag)})
    if (do_part_without(joint)) return joint;
  return {};
}

std::size_t TagPaths::num_joint_frames(int a, int b) const {
  const auto of_a = frames_of_tag_.find(a), of_b = frames_of_tag_.find(b);
  if (of_a == frames_of_tag_.end() || of_b == frames_of_tag_.end()) return 0;
  return static_cast<std::size_t>(
      std::ranges::count_if(of_a->second, [&](int frame) { return of_b->second.contains(frame); }));
}

std::set<int> TagPaths::beside(int tag) const {
  std::set<int> tags;
  const auto frames = frames_of_tag_.find(tag);
  if (frames == frames_of_tag_.end()) return tags;
  for (const int frame : frames->second) {
    const std::set<int>& seen = tags_of_frame_.at(frame);
    tags.insert(seen.begin(), seen.end());
  }
  tags.erase(tag);
  return tags;
}

}  // namespace apriltrack
