#include "observations/parts.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "apriltrack/base/disjoint_sets.h"

namespace apriltrack {
namespace {

/// Distinct tags of each frame, counting only `views`.
std::map<int, std::set<int>> tags_by_frame(const Observations& observations,
                                           const std::vector<std::size_t>& views) {
  std::map<int, std::set<int>> tags;
  for (const std::size_t v : views) tags[observations.views[v].frame].insert(observations.views[v].tag);
  return tags;
}

/// Of each frame; -1 where no other was taken from there.
std::vector<int> places_of_frames(const Observations& observations, const std::vector<std::size_t>& views) {
  std::vector<int> places(observations.frames.size(), -1);
  for (const std::size_t v : views)
    places[static_cast<std::size_t>(observations.views[v].frame)] = observations.views[v].place;
  return places;
}

/// Frames in which each tag is seen together with another; those of one place count once.
std::vector<int> count_joint_frames(const Observations& observations, const std::vector<std::size_t>& views,
                                    const std::map<int, std::set<int>>& frames) {
  std::vector<int> count(observations.tags.size(), 0);
  const std::vector<int> places = places_of_frames(observations, views);
  std::set<std::pair<int, int>> counted;
  for (const auto& [frame, tags] : frames) {
    if (tags.size() < 2) continue;
    const int place = places[static_cast<std::size_t>(frame)];
    for (const int tag : tags)
      if (place < 0 || counted.emplace(tag, place).second) ++count[static_cast<std::size_t>(tag)];
  }
  return count;
}

/// Removes tags with too few joint frames until none is left that has: each removal may make a neighbour
/// lone.
std::vector<std::size_t> keep_supported(const Observations& observations, std::vector<std::size_t> views,
                                        int min_views) {
  while (true) {
    const auto frames = tags_by_frame(observations, views);
    const std::vector<int> joint = count_joint_frames(observations, views, frames);
    const auto is_weak = [&](std::size_t v) {
      const TagView& view = observations.views[v];
      return joint[static_cast<std::size_t>(view.tag)] < min_views || frames.at(view.frame).size() < 2;
    };
    if (std::erase_if(views, is_weak) == 0) return views;
  }
}

std::vector<Part> split_by_connection(const Observations& observations,
                                      const std::vector<std::size_t>& views) {
  DisjointSets sets(observations.tags.size());
  for (const auto& [frame, tags] : tags_by_frame(observations, views)) {
    for (const int tag : tags)
      sets.join(static_cast<std::size_t>(*tags.begin()), static_cast<std::size_t>(tag));
  }
  std::map<std::size_t, Part> by_root;
  for (const std::size_t v : views)
    by_root[sets.find(static_cast<std::size_t>(observations.views[v].tag))].views.push_back(v);
  std::vector<Part> parts;
  for (auto& [root, part] : by_root) {
    std::set<int> tags;
    for (const std::size_t v : part.views) tags.insert(observations.views[v].tag);
    part.tags.assign(tags.begin(), tags.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

std::span<const std::size_t> views_of_frame(const Observations& observations, const Part& part, int frame) {
  // Not equal_range(): its subrange is none to Clang 14 and 15.
  const auto frame_of = [&](std::size_t v) { return observations.views[v].frame; };
  return {std::ranges::lower_bound(part.views, frame, {}, frame_of),
          std::ranges::upper_bound(part.views, frame, {}, frame_of)};
}

std::map<int, int> count_views(const Observations& observations, const Part& part) {
  std::map<int, int> count;
  for (const std::size_t v : part.views) ++count[observations.views[v].tag];
  return count;
}

Part narrowed_to(const Observations& observations, const Part& part, const std::vector<int>& tags) {
  std::vector<std::size_t> views = part.views;
  std::erase_if(views, [&](std::size_t v) {
    return !std::binary_search(tags.begin(), tags.end(), observations.views[v].tag);
  });
  const auto frames = tags_by_frame(observations, views);
  std::erase_if(views, [&](std::size_t v) { return frames.at(observations.views[v].frame).size() < 2; });
  return {tags, std::move(views)};
}

std::vector<std::size_t> views_without(const Observations& observations, const Part& part,
                                       const std::set<int>& tags) {
  std::vector<std::size_t> views = part.views;
  std::erase_if(views, [&](std::size_t v) { return tags.contains(observations.views[v].tag); });
  return views;
}

Connectivity find_parts(const Observations& observations, const std::vector<std::size_t>& views,
                        int min_views) {
  Connectivity result;
  const std::vector<int> joint_frames =
      count_joint_frames(observations, views, tags_by_frame(observations, views));
  result.parts = split_by_connection(observations, keep_supported(observations, views, min_views));
  std::sort(result.parts.begin(), result.parts.end(), [](const Part& a, const Part& b) {
    return a.tags.size() != b.tags.size() ? a.tags.size() > b.tags.size() : a.tags < b.tags;
  });

  std::set<int> seen, kept;
  for (const std::size_t v : views) seen.insert(observations.views[v].tag);
  for (const Part& part : result.parts) kept.insert(part.tags.begin(), part.tags.end());
  for (const int tag : seen) {
    if (kept.contains(tag)) continue;
    (joint_frames[static_cast<std::size_t>(tag)] == 0 ? result.lone_tags : result.rare_tags).push_back(tag);
  }
  return result;
}

std::vector<int> free_tags(const Part& part, int held_tag) {
  std::vector<int> tags = part.tags;
  std::erase(tags, held_tag);
  return tags;
}

Part connected_to(const Observations& observations, const std::vector<std::size_t>& views, int held_tag,
                  int min_views) {
  for (Part& part : find_parts(observations, views, min_views).parts) {
    if (std::binary_search(part.tags.begin(), part.tags.end(), held_tag)) return std::move(part);
  }
  return {};
}

}  // namespace apriltrack
