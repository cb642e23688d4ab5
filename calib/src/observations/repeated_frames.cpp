#include "observations/repeated_frames.h"

#include <algorithm>
#include <set>

namespace apriltrack {
namespace {

/// What a moment shows, as numbers to compare.
std::vector<double> shown(std::span<const TagView> views) {
  std::vector<double> numbers;
  for (const TagView& view : views) {
    numbers.push_back(view.camera);
    numbers.push_back(view.tag);
    for (const Eigen::Vector2d& corner : view.corners_px)
      numbers.insert(numbers.end(), {corner.x(), corner.y()});
  }
  return numbers;
}

}  // namespace

int drop_repeated_frames(Observations& observations, const std::set<Timestamp>& kept) {
  std::set<std::vector<double>> seen;
  std::set<int> repeated;
  const std::span<const TagView> views = observations.views;
  for (auto begin = views.begin(); begin != views.end();) {
    const int frame = begin->frame;
    const auto end = std::find_if(begin, views.end(), [&](const TagView& v) { return v.frame != frame; });
    const bool is_new = seen.insert(shown({begin, end})).second;
    if (!is_new && !kept.contains(observations.frames[static_cast<std::size_t>(frame)]))
      repeated.insert(frame);
    begin = end;
  }
  std::erase_if(observations.views, [&](const TagView& view) { return repeated.contains(view.frame); });
  return static_cast<int>(repeated.size());
}

}  // namespace apriltrack
