#include "split_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "apriltrack/base/error.h"
#include "calibration_words.h"
#include "tag_places.h"

namespace apriltrack {
namespace {

/// By frame, then by tag.
using ViewsByFrame = std::map<int, std::map<int, std::size_t>>;

ViewsByFrame by_frame(const Observations& observations, const Part& part) {
  ViewsByFrame frames;
  for (const std::size_t v : part.views)
    frames[observations.views[v].frame].emplace(observations.views[v].tag, v);
  return frames;
}

/// Without it, what is seen beside it falls apart.
bool does_join_alone(const Observations& observations, const Part& kept, int tag) {
  const Connectivity rest = find_parts(observations, views_without(observations, kept, {tag}), 1);
  return rest.parts.size() + rest.lone_tags.size() > 1;
}

/// A tag, and one that frames show with it at another place than the map does.
struct SplitLink {
  int tag = 0, beside = 0;
  std::vector<std::size_t> views;  ///< Of both, in those frames; sorted.
  std::size_t num_frames = 0;      ///< That show both.

  Part part() const { return {{std::min(tag, beside), std::max(tag, beside)}, views}; }
};

/// Of tags with which some frames fit, and others do not.
std::vector<SplitLink> links_of(const ViewsByFrame& frames, const Part& kept, int tag) {
  std::map<int, SplitLink> links;
  const auto is_kept = [&](std::size_t v) { return std::ranges::binary_search(kept.views, v); };
  for (const auto& [frame, views] : frames) {
    const auto own = views.find(tag);
    if (own == views.end()) continue;
    for (const auto& [beside, v] : views) {
      if (beside == tag) continue;
      SplitLink& link = links.try_emplace(beside, SplitLink{tag, beside, {}, 0}).first->second;
      ++link.num_frames;
      if (is_kept(own->second)) continue;
      link.views.insert(link.views.end(), {own->second, v});
    }
  }
  std::vector<SplitLink> split;
  for (auto& [beside, link] : links) {
    std::ranges::sort(link.views);
    const std::size_t lost = link.views.size() / 2;
    if (lost > 0 && lost < link.num_frames) split.push_back(std::move(link));
  }
  return split;
}

struct OtherPlace {
  std::size_t num_frames = 0;  ///< That agree in it.
  Pose change;                 ///< From where the map has the tag.
};

/// nullopt where the frames do not agree in one, by the noise that the map has. Of a single frame it is told
/// where the tag cannot have been nudged for a moment: two hang there.
std::optional<OtherPlace> place_by(const PartTask& task, const SplitLink& link, const MapState& state) {
  CalibrationOptions options = task.options;
  options.held_tag.reset();
  options.min_views = 1;
  Observations by_cameras = task.observations;
  by_cameras.cameras = state.cameras;
  AdjustedPart alike;
  try {
    alike =
        adjust_part({by_cameras, task.candidates, options}, link.part(), link.beside, on_one_thread(task));
    alike.state.noise = {state.noise.sum, state.noise.difference, {}};
    alike.part.views = inliers(task.observations, alike.part.views, alike.state);
  } catch (const Error&) {
    return std::nullopt;
  }
  const auto of = [&](int tag, const MapState& map) { return map.T_map_tag[static_cast<std::size_t>(tag)]; };
  const auto seen_from = [&](const MapState& map) {
    return of(link.beside, map).inverse() * of(link.tag, map);
  };
  const OtherPlace place{alike.part.views.size() / 2, seen_from(state).inverse() * seen_from(alike.state)};
  const double size_m = task.observations.sizes_m[static_cast<std::size_t>(link.tag)];
  const double least_m = place.num_frames > 1 ? least_shift_m(place.change, size_m) : kOneObject_m;
  const bool is_other = place.num_frames > 0 && place.change.translation().norm() > least_m;
  return is_other ? std::optional(place) : std::nullopt;
}

std::string words_of(const Observations& observations, const SplitLink& link, const OtherPlace& place) {
  const std::string name = to_string(key_of(observations, link.tag));
  const std::string beside = to_string(key_of(observations, link.beside));
  return fmt::format(
      "{0} and {1} are seen together in {2} frames, of which {3} {0} {4:.2g} m from where the map has it. "
      "{0} "
      "alone joins other tags to the map: if it hangs twice (a duplicate) or was moved, the map may be "
      "folded "
      "there. Look for a second {0}, and film it together with more of the others",
      name, beside, link.num_frames,
      place.num_frames == 1 ? "1 shows" : fmt::format("{} show", place.num_frames),
      place.change.translation().norm());
}

}  // namespace

std::vector<std::string> words_of_split_links(const PartTask& task, const Part& offered, const Part& kept,
                                              const MapState& state) {
  const ViewsByFrame frames = by_frame(task.observations, offered);
  std::vector<std::string> words;
  for (const int tag : kept.tags) {
    const std::vector<SplitLink> links = links_of(frames, kept, tag);
    if (links.empty() || !does_join_alone(task.observations, kept, tag)) continue;
    for (const SplitLink& link : links) {
      const std::optional<OtherPlace> place = place_by(task, link, state);
      if (!place) continue;
      words.push_back(words_of(task.observations, link, *place));
      break;
    }
  }
  return words;
}

}  // namespace apriltrack
