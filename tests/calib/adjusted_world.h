#pragma once

#include <algorithm>
#include <functional>
#include <numeric>
#include <vector>

#include "apriltrack/geometry/tag_corners.h"
#include "initialise/part_adjustment.h"
#include "synthetic_world.h"

namespace apriltrack::test {

/// The largest part of what was seen of a world, as it was offered, and adjusted.
struct AdjustedWorld {
  SyntheticWorld world;
  CalibrationOptions options;
  UnusedDetections unused;
  Observations observations;
  std::vector<ViewCandidates> candidates;
  Part offered;
  AdjustedPart solved;

  explicit AdjustedWorld(SyntheticWorld stated) : AdjustedWorld(stated, exact_detections(stated)) {}
  AdjustedWorld(SyntheticWorld stated, const std::vector<FrameDetections>& frames,
                const CalibrationOptions& chosen = {})
      : world(std::move(stated)),
        options(chosen),
        observations(collect_observations(frames, world.rig, world.sizes(), options, unused)) {
    std::vector<std::size_t> views(observations.views.size());
    std::iota(views.begin(), views.end(), std::size_t{0});
    candidates = solve_views(observations, views, parallel_for(1));
    offered = find_parts(observations, views, options.min_views).parts.front();
    solved = adjust_part(task(), offered, offered.tags.front(), parallel_for(1)).value_or_throw();
  }

  PartTask task() const { return {observations, candidates, options}; }
  int index_of(int id) const {
    return static_cast<int>(std::ranges::find(observations.tags, id, &TagKey::id) -
                            observations.tags.begin());
  }
};

/// Of tags in a row each frame keeps two neighbours, by turns: a chain.
inline void show_two_neighbours(int num_tags, std::vector<FrameDetections>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int first = static_cast<int>(i) % (num_tags - 1);
    std::erase_if(frames[i].detections, [&](const Detection& detection) {
      return detection.tag.id != first && detection.tag.id != first + 1;
    });
  }
}

/// What the world shows when the corners of one tag are elsewhere in its own frame. moved: the corner, and
/// the number of the frame, to where it is then.
inline std::vector<FrameDetections> filmed_with(
    const SyntheticWorld& world, int id,
    const std::function<Eigen::Vector3d(Eigen::Vector3d, std::size_t)>& moved) {
  std::vector<FrameDetections> frames = exact_detections(world);
  const MapTag& tag = *world.map.find({"tag36h11", id});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (Detection& detection : frames[i].detections) {
      if (detection.tag != tag.key) continue;
      const auto corners = tag_corners(tag.size_m);
      for (std::size_t c = 0; c < corners.size(); ++c)
        detection.corners_px[c] = *world.rig.cameras[0].model.project(world.T_world_rig[i].inverse() *
                                                                      tag.T_map_tag * moved(corners[c], i));
    }
  }
  return frames;
}

}  // namespace apriltrack::test
