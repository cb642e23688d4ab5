#include "faults/split_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/calib/calibration_options.h"
#include "faults/tag_places.h"
#include "observations/tag_paths.h"
#include "solve/frame_views.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostSplits = 6, kMostAsked = 60;
// Of half the robust sum of squares, of a frame: by how much it must cost more where the map has the tag,
// whatever the frame's pose.
constexpr double kPlainlyElsewhere = 20.0;

/// A tag, and one that frames show with it while the map gives up how they see it.
struct JointViews {
  int tag = 0, beside = 0;
  std::map<int, std::vector<std::size_t>> views_of_frame;  ///< Of both, in those frames; sorted.
  std::size_t num_frames = 0;                              ///< That show both.

  Part part() const {
    Part part{{std::min(tag, beside), std::max(tag, beside)}, {}};
    for (const auto& [frame, views] : views_of_frame)
      part.views.insert(part.views.end(), views.begin(), views.end());
    return part;
  }
};

/// Views of a part by frame, and in it by tag: of several cameras, more than one.
using ViewsByFrame = std::map<int, std::map<int, std::vector<std::size_t>>>;

ViewsByFrame by_frame(const Observations& observations, const Part& part) {
  ViewsByFrame frames;
  for (const std::size_t v : part.views)
    frames[observations.views[v].frame][observations.views[v].tag].push_back(v);
  return frames;
}

/// Of all pairs of tags that some frames show, in part of which the map keeps no view of one. Each is told
/// of either, for the other may be what hangs twice. Most such frames first.
std::vector<JointViews> lost_in_part(const Observations& observations, const Part& offered,
                                     const Part& kept) {
  const ViewsByFrame frames = by_frame(observations, offered);
  std::map<std::pair<int, int>, JointViews> links;
  const auto add = [&](int tag, int beside, int frame, const std::vector<std::size_t>& views) {
    links.try_emplace({tag, beside}, JointViews{tag, beside, {}, 0}).first->second.views_of_frame[frame] =
        views;
  };
  for (const auto& [frame, tags] : frames) {
    for (const auto& [tag, own] : tags) {
      if (std::ranges::any_of(own, [&](std::size_t v) { return std::ranges::binary_search(kept.views, v); }))
        continue;
      for (const auto& [beside, others] : tags) {
        if (beside == tag) continue;
        std::vector<std::size_t> views;
        std::ranges::merge(own, others, std::back_inserter(views));
        add(tag, beside, frame, views);
        add(beside, tag, frame, views);
      }
    }
  }
  const TagPaths seen(observations, offered);
  std::vector<JointViews> split;
  for (auto& [tags, link] : links) {
    link.num_frames = seen.num_joint_frames(link.tag, link.beside);
    if (link.views_of_frame.size() < link.num_frames) split.push_back(std::move(link));
  }
  std::ranges::stable_sort(split, std::greater<>(),
                           [](const auto& one) { return one.views_of_frame.size(); });
  return split;
}

struct OtherPlace {
  std::size_t num_frames = 0;  ///< That agree in it, and not with the map.
  Pose change;                 ///< From where the map has the tag.
};

Pose seen_from(const JointViews& link, const MapState& state) {
  return state.T_map_tag[static_cast<std::size_t>(link.beside)].inverse() *
         state.T_map_tag[static_cast<std::size_t>(link.tag)];
}

/// Of a frame that shows both, wherever it is.
double least_cost(const PartTask& task, const std::vector<std::size_t>& views, MapState state) {
  FrameViews frame(task, views, state);
  return std::min(frame.settle(), frame.best_of_proposals().first);
}

/// nullopt where the frames do not agree in one, by the noise that the map has, or hardly less with the map.
/// Of a single frame it is told where the tag cannot have been nudged for a moment: two hang there.
std::optional<OtherPlace> place_by(const PartTask& task, const JointViews& link, const MapState& state) {
  Outcome<AdjustedPart> alike = adjust_part(task, link.part(), link.beside, on_one_thread(task));
  if (!alike) return std::nullopt;
  MapState in_map = state;
  in_map.noise = alike->state.noise = state.noise.of_all();
  const std::vector<std::size_t> fitting = inliers(task.observations, alike->part.views, alike->state);
  OtherPlace place{0, seen_from(link, state).inverse() * seen_from(link, alike->state)};
  for (const auto& [frame, views] : link.views_of_frame) {
    if (!std::ranges::includes(fitting, views)) continue;
    if (least_cost(task, views, in_map) > least_cost(task, views, alike->state) + kPlainlyElsewhere)
      ++place.num_frames;
  }
  const double size_m = task.observations.sizes_m[static_cast<std::size_t>(link.tag)];
  const double least_m = place.num_frames > 1 ? least_shift_m(place.change, size_m) : kOneObject_m;
  const bool is_other = place.num_frames > 0 && place.change.translation().norm() > least_m;
  return is_other ? std::optional(place) : std::nullopt;
}

}  // namespace

std::vector<SplitLink> find_split_links(const PartTask& task, const Part& offered, const Part& kept,
                                        const MapState& state) {
  const std::vector<JointViews> links = lost_in_part(task.observations, offered, kept);
  if (links.empty()) return {};
  Observations by_cameras = task.observations;
  by_cameras.cameras = state.cameras;
  CalibrationOptions options = task.options;
  options.held_tag.reset();
  options.min_views = 1;
  const PartTask of_links{by_cameras, task.candidates, options};
  const TagPaths paths(task.observations, kept);
  std::map<int, std::set<int>> known_joints;
  const auto joint_at = [&](int tag) -> const std::set<int>& {
    const auto [known, is_new] = known_joints.try_emplace(tag);
    if (is_new) known->second = paths.joint_at(tag);
    return known->second;
  };
  std::set<int> known;
  std::set<std::pair<int, int>> asked_of;  // either way round the two are solved alike
  std::vector<SplitLink> split;
  std::size_t asked = 0;
  for (const JointViews& link : links) {
    const std::set<int>& joint = joint_at(link.tag);
    if (known.contains(link.tag) || joint.empty() || joint.contains(link.beside)) continue;
    if (!asked_of.insert(std::minmax(link.tag, link.beside)).second) continue;
    if (split.size() == kMostSplits || ++asked > kMostAsked) break;
    const auto place = place_by(of_links, link, state);
    if (!place) continue;
    known.insert(joint.begin(), joint.end());
    split.push_back({link.tag,
                     link.beside,
                     link.num_frames,
                     place->num_frames,
                     place->change,
                     {joint.begin(), joint.end()}});
  }
  return split;
}

}  // namespace apriltrack
