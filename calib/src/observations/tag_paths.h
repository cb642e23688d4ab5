#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "observations/parts.h"

namespace apriltrack {

/// Which tags are seen together: a graph of tags and frames.
class TagPaths {
 public:
  /// ties: whose views make the graph.
  TagPaths(const Observations& observations, const Part& ties);

  /// The tags of a shortest path, ends included, that goes round some; empty where there is none.
  std::vector<int> shortest(const std::set<int>& from, const std::set<int>& to,
                            const std::set<int>& avoided) const;

  /// The tag, and those that are hardly ever seen but with it, nor it but with them: they may be on one
  /// board, and such a board is carried, and hangs twice, as one. The tag alone where these are more than
  /// half of all: that is a desk that each frame shows whole.
  std::set<int> board_of(int tag) const;

  /// The tag, or else its board, where every way from some tags to others, ends included, leads through it;
  /// or empty.
  std::set<int> joint_at(int tag, const std::set<int>& from, const std::set<int>& to) const;

  /// The tag, or else its board, where it alone joins some that are seen together with it to others; or
  /// empty.
  std::set<int> joint_at(int tag) const;

  /// In how many frames two tags are seen together.
  std::size_t num_joint_frames(int a, int b) const;

 private:
  std::set<int> beside(int tag) const;
  bool do_part_without(const std::set<int>& tags) const;

  std::map<int, std::set<int>> tags_of_frame_, frames_of_tag_;
};

}  // namespace apriltrack
