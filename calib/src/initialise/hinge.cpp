#include "initialise/hinge.h"

#include <algorithm>
#include <set>

#include "numerics/spread_selection.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostFramesOfHinge = 40, kLeastFramesOfHinge = 6;
constexpr std::size_t kMostViewsOfHinge = 160;
constexpr std::size_t kFewFramesOfHinge = 8;  // which may show already that a pose is no match
constexpr std::size_t kMostAnchors = 2;       // on either side of a hinge

std::vector<int> most_seen_tags(const std::map<int, int>& counts) {
  std::vector<int> tags;
  for (const auto& [tag, count] : counts) tags.push_back(tag);
  std::stable_sort(tags.begin(), tags.end(), [&](int a, int b) { return counts.at(a) > counts.at(b); });
  tags.resize(std::min(tags.size(), kMostAnchors));
  return tags;
}

}  // namespace

ViewIndex::ViewIndex(const Observations& observations, const Part& part)
    : observations_(&observations), part_(&part) {
  int last_frame = -1;
  for (const std::size_t v : part.views) {
    const TagView& view = observations.views[v];
    of_tag_[view.tag].push_back(v);
    num_frames_ += view.frame != last_frame ? 1 : 0;
    last_frame = view.frame;
  }
}

std::size_t ViewIndex::views_per_frame() const {
  return part_->views.size() / std::max<std::size_t>(1, num_frames_);
}

std::span<const std::size_t> ViewIndex::of_frame(std::size_t frame) const {
  return views_of_frame(*observations_, *part_, static_cast<int>(frame));
}

std::vector<std::size_t> ViewIndex::joint_frames(const std::vector<int>& group) const {
  std::set<std::size_t> frames;
  for (const int tag : group) {
    const auto views = of_tag_.find(tag);
    if (views == of_tag_.end()) continue;
    for (const std::size_t v : views->second)
      frames.insert(static_cast<std::size_t>(observations_->views[v].frame));
  }
  std::erase_if(frames, [&](std::size_t frame) {
    return std::ranges::all_of(of_frame(frame), [&](std::size_t v) { return is_of(group, v); });
  });
  return {frames.begin(), frames.end()};
}

bool ViewIndex::is_of(const std::vector<int>& group, std::size_t v) const {
  return std::ranges::binary_search(group, observations_->views[v].tag);
}

Hinge find_hinge(const Observations& observations, const ViewIndex& index, const std::vector<int>& group) {
  const std::size_t num_frames =
      std::clamp(kMostViewsOfHinge / std::max<std::size_t>(1, index.views_per_frame()), kLeastFramesOfHinge,
                 kMostFramesOfHinge);
  Hinge hinge;
  std::map<int, int> counts, other_counts;
  const std::vector<std::size_t> frames = spread_selection(index.joint_frames(group), num_frames);
  for (const std::size_t frame : frames) {
    for (const std::size_t v : index.of_frame(frame)) {
      hinge.views.push_back(v);
      ++(index.is_of(group, v) ? counts : other_counts)[observations.views[v].tag];
    }
  }
  for (const std::size_t frame : spread_selection(frames, kFewFramesOfHinge)) {
    const auto views = index.of_frame(frame);
    hinge.few_views.insert(hinge.few_views.end(), views.begin(), views.end());
  }
  hinge.anchors = most_seen_tags(counts);
  hinge.other_anchors = most_seen_tags(other_counts);
  return hinge;
}

}  // namespace apriltrack
