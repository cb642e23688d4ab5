#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "observations/observations.h"

namespace apriltrack {

/// Tags that frames join, and the views that do so.
struct Part {
  std::vector<int> tags;  ///< Sorted.
  std::vector<std::size_t>
      views;  ///< Into Observations::views; only of frames that show two tags of the part or more.
};

/// Those of the part's views that are of the frame, as its views are sorted by frame.
std::span<const std::size_t> views_of_frame(const Observations& observations, const Part& part, int frame);

/// How many of the part's views show each of its tags, by tag.
std::map<int, int> count_views(const Observations& observations, const Part& part);

/// What of the part counts where only `tags` (sorted) are mapped: their views in frames that show two of
/// them.
Part narrowed_to(const Observations& observations, const Part& part, const std::vector<int>& tags);

/// The part's views but those of `tags`.
std::vector<std::size_t> views_without(const Observations& observations, const Part& part,
                                       const std::set<int>& tags);

struct Connectivity {
  std::vector<Part> parts;     ///< Most tags first; equal ones by their first tag.
  std::vector<int> lone_tags;  ///< Never seen together with another tag.
  std::vector<int> rare_tags;  ///< Seen together with another, but in fewer than min_views frames; those of
                               ///< one place count once.
};

/// views: the views to count (into observations.views), sorted. A frame ties together all its tags.
Connectivity find_parts(const Observations& observations, const std::vector<std::size_t>& views,
                        int min_views);

/// All but the one that is held.
std::vector<int> free_tags(const Part& part, int held_tag);

/// What of `part` the views still tie to the held tag; an empty part when it stands alone.
Part connected_to(const Observations& observations, const std::vector<std::size_t>& views, int held_tag,
                  int min_views);

}  // namespace apriltrack
