#pragma once

#include <map>
#include <set>
#include <vector>

#include "parts.h"

namespace apriltrack {

/// Which tags are seen together: a graph of tags and frames.
class TagPaths {
 public:
  /// ties: whose views make the graph.
  TagPaths(const Observations& observations, const Part& ties);

  /// The tags of a shortest path, ends included, that avoids one (-1: none); empty where there is none.
  std::vector<int> shortest(const std::set<int>& from, const std::set<int>& to, int avoided) const;

  /// Whether some that are seen together with the tag are joined to the others by it alone.
  bool does_join_alone(int tag) const;

 private:
  std::map<int, std::set<int>> tags_of_frame_, frames_of_tag_;
};

}  // namespace apriltrack
