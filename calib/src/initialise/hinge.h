#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "observations/parts.h"

namespace apriltrack {

/// A part's views by tag and by frame, so that a group of tags costs no more than what is seen of it.
class ViewIndex {
 public:
  ViewIndex(const Observations& observations, const Part& part);

  std::size_t views_per_frame() const;
  std::span<const std::size_t> of_frame(std::size_t frame) const;
  /// Those that show a tag of the group, and another one; sorted. group: sorted.
  std::vector<std::size_t> joint_frames(const std::vector<int>& group) const;
  /// Whether view `v` is of a tag of the group.
  bool is_of(const std::vector<int>& group, std::size_t v) const;

 private:
  const Observations* observations_;
  const Part* part_;
  std::map<int, std::vector<std::size_t>> of_tag_;
  std::size_t num_frames_ = 0;
};

/// Where a group of tags meets the others: the frames that show both, and their views.
struct Hinge {
  std::vector<std::size_t> views;
  std::vector<std::size_t> few_views;       ///< Of few of the frames.
  std::vector<int> anchors, other_anchors;  ///< Tags of the group, and others, seen most often there.
};

/// Of many frames an even selection. group: sorted.
Hinge find_hinge(const Observations& observations, const ViewIndex& index, const std::vector<int>& group);

}  // namespace apriltrack
