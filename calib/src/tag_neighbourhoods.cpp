#include "tag_neighbourhoods.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "tag_links.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostNeighbours = 24;

}  // namespace

TagNeighbourhoods::TagNeighbourhoods(const Observations& observations, Part part, std::size_t most_frames)
    : part_(std::move(part)), most_frames_(most_frames) {
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

std::set<std::size_t> TagNeighbourhoods::frames_around(int tag, const std::vector<int>& neighbours) const {
  const std::vector<std::size_t>& of_tag = frames_of_tag_.at(tag);
  const std::set<std::size_t> with_tag(of_tag.begin(), of_tag.end());
  std::set<std::size_t> others;
  for (const int one : neighbours)
    others.insert(frames_of_tag_.at(one).begin(), frames_of_tag_.at(one).end());
  std::erase_if(others, [&](std::size_t frame) { return with_tag.contains(frame); });
  std::set<std::size_t> frames;
  for (const auto& some : {with_tag, others}) {
    const std::vector<std::size_t> spread = spread_selection({some.begin(), some.end()}, most_frames_);
    frames.insert(spread.begin(), spread.end());
  }
  return frames;
}

Part TagNeighbourhoods::around(int tag) const {
  if (are_all_one()) return part_;
  Part part{neighbours_of(tag), {}};
  for (const std::size_t f : frames_around(tag, part.tags)) {
    const Frame& frame = frames_[f];
    std::vector<std::size_t> views;
    std::set<int> seen;
    for (std::size_t i = 0; i < frame.tags.size(); ++i) {
      if (!std::ranges::binary_search(part.tags, frame.tags[i])) continue;
      views.push_back(frame.views[i]);
      seen.insert(frame.tags[i]);
    }
    if (seen.size() > 1) part.views.insert(part.views.end(), views.begin(), views.end());
  }
  return part;
}

}  // namespace apriltrack
