#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "observations/parts.h"

namespace apriltrack {

/// What of a large part, or of a long recording, is near one of the tags.
class TagNeighbourhoods {
 public:
  /// observations: outlive this. most_frames: that show the tag, and as many others.
  TagNeighbourhoods(const Observations& observations, Part part, std::size_t most_frames);

  /// Whether the part is so small that it is the neighbourhood of each.
  bool are_all_one() const;
  /// The tag, those that are seen with it most often, and what some frames, spread evenly, show of them, as
  /// far as it hangs together; all of a small part. Empty where no frame shows the tag with another.
  Part around(int tag) const;

 private:
  struct Frame {
    std::vector<int> tags;           ///< Of the views.
    std::vector<std::size_t> views;  ///< Into Observations::views.
  };

  std::vector<int> neighbours_of(int tag) const;
  std::set<std::size_t> frames_around(int tag, const std::vector<int>& neighbours) const;

  const Observations* observations_;
  Part part_;
  std::size_t most_frames_;
  std::vector<Frame> frames_;
  std::map<int, std::vector<std::size_t>> frames_of_tag_;  ///< Into frames_; sorted, a frame once a view.
};

}  // namespace apriltrack
