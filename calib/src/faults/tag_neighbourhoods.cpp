#include "faults/tag_neighbourhoods.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "initialise/part_adjustment.h"
#include "numerics/spread_selection.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostNeighbours = 24;
constexpr int kLeastFramesOfTag = 3;  // fewer do not tell its pose well

}  // namespace

TagNeighbourhoods::TagNeighbourhoods(const Observations& observations, Part part, std::size_t most_frames)
    : observations_(&observations), part_(std::move(part)), most_frames_(most_frames) {
  int last = -1;
  for (const std::size_t v : part_.views) {
    const TagView& view = observations.views[v];
    if (frames_.empty() || view.frame != last) frames_.emplace_back();
    last = view.frame;
    frames_.back().tags.push_back(view.tag);
    frames_.back().views.push_back(v);
    frames_of_tag_[view.tag].push_back(frames_.size() - 1);
  }
}

bool TagNeighbourhoods::are_all_one() const {
  return part_.tags.size() <= kMostNeighbours && frames_.size() <= 2 * most_frames_;
}

std::vector<int> TagNeighbourhoods::neighbours_of(int tag) const {
  std::map<int, int> shared;
  for (const std::size_t frame : frames_of_tag_.at(tag)) {
    for (const int other : frames_[frame].tags) ++shared[other];
  }
  shared.erase(tag);
  std::vector<int> tags;
  for (const auto& [other, frames] : shared) tags.push_back(other);
  std::ranges::stable_sort(tags, std::greater<>(), [&](int other) { return shared[other]; });
  tags.resize(std::min(tags.size(), kMostNeighbours - 1));
  tags.push_back(tag);
  std::ranges::sort(tags);
  return tags;
}

// Frames that show two of the neighbours or more: those with the tag, and others.
std::set<std::size_t> TagNeighbourhoods::frames_around(int tag, const std::vector<int>& neighbours) const {
  std::map<std::size_t, std::set<int>> seen;
  for (const int one : neighbours) {
    for (const std::size_t frame : frames_of_tag_.at(one)) seen[frame].insert(one);
  }
  std::vector<std::size_t> with_tag, others;
  for (const auto& [frame, tags] : seen) {
    if (tags.size() > 1) (tags.contains(tag) ? with_tag : others).push_back(frame);
  }
  std::set<std::size_t> frames;
  for (const auto& some : {with_tag, others}) {
    const std::vector<std::size_t> spread = spread_selection(some, most_frames_);
    frames.insert(spread.begin(), spread.end());
  }
  return frames;
}

Part TagNeighbourhoods::around(int tag) const {
  if (!frames_of_tag_.contains(tag)) return {};
  if (are_all_one()) return part_;
  const std::vector<int> neighbours = neighbours_of(tag);
  std::vector<std::size_t> views;
  for (const std::size_t f : frames_around(tag, neighbours)) {
    const Frame& frame = frames_[f];
    for (std::size_t i = 0; i < frame.tags.size(); ++i) {
      if (std::ranges::binary_search(neighbours, frame.tags[i])) views.push_back(frame.views[i]);
    }
  }
  return connected_to(*observations_, views, tag, kLeastFramesOfTag);
}

}  // namespace apriltrack
