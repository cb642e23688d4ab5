#include "faults/rejected_stands.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace apriltrack {
namespace {

constexpr int kManyFrames = 5;
constexpr std::size_t kMostStands = 6;

/// A tag by itself, or several of which any may be elsewhere, at one place.
using Stand = std::pair<std::set<int>, int>;

struct Misfit {
  int frames = 0;
  Timestamp first;
};

std::map<Stand, Misfit> misfits_of_stands(const Observations& observations, const Part& kept,
                                          const std::vector<std::size_t>& rejected) {
  std::set<int> frames_that_fit;
  for (const std::size_t v : kept.views) frames_that_fit.insert(observations.views[v].frame);
  std::map<int, std::set<int>> tags_of_frame;  // of those in which nothing fits
  for (const std::size_t v : rejected) {
    const TagView& view = observations.views[v];
    if (!frames_that_fit.contains(view.frame)) tags_of_frame[view.frame].insert(view.tag);
  }
  std::map<Stand, Misfit> misfits;
  std::set<std::pair<Stand, int>> counted;
  for (const std::size_t v : rejected) {
    const TagView& view = observations.views[v];
    const auto tags = tags_of_frame.find(view.frame);
    const Stand stand{tags == tags_of_frame.end() ? std::set{view.tag} : tags->second, view.place};
    if (!counted.emplace(stand, view.frame).second) continue;
    Misfit& misfit =
        misfits.try_emplace(stand, Misfit{0, observations.frames[static_cast<std::size_t>(view.frame)]})
            .first->second;
    misfit.frames += view.num_frames;
  }
  return misfits;
}

}  // namespace

std::vector<RejectedStand> find_rejected_stands(const Observations& observations, const Part& kept,
                                                const std::vector<std::size_t>& rejected) {
  std::vector<RejectedStand> stands;
  for (const auto& [stand, misfit] : misfits_of_stands(observations, kept, rejected)) {
    if (misfit.frames >= kManyFrames && stands.size() < kMostStands)
      stands.push_back({{stand.first.begin(), stand.first.end()}, misfit.frames, misfit.first});
  }
  return stands;
}

}  // namespace apriltrack
