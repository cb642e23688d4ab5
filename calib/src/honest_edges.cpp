#include "honest_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "corner_views.h"
#include "predicted_edges.h"

namespace apriltrack {
namespace {

// Edges are no more constant than that: by the slower half of a hand-held recording they are found 0.14 px
// from where they are by the faster one (euroc_aprilgrid). What moves them less does not matter.
constexpr double kInconstantEdges_px = 0.1;

/// The most by which an edge offset differs; one that is not estimated is 0.
double most_difference_px(const CameraRefinement& a, const CameraRefinement& b) {
  std::map<int, double> difference_px;
  const auto add = [&](const CameraRefinement& cameras, double sign) {
    if (!cameras.is_accepted) return;
    for (const EstimatedParameter& one : cameras.estimates)
      if (one.parameter.kind == CameraParameter::Kind::kEdgeOffset)
        difference_px[one.parameter.camera] += sign * one.value;
  };
  add(a, 1.0);
  add(b, -1.0);
  double most = 0.0;
  for (const auto& [camera, value] : difference_px) most = std::max(most, std::abs(value));
  return most;
}

struct Improved {
  AdjustedPart solved;
  BetterCameras cameras;
};

/// What is improved with the edges of `by_map` instead. nullopt where these give no map.
std::optional<Improved> improved_by_edges_of_map(const PartTask& task, const Observations& by_map,
                                                 const Part& part, const Improvement& improve,
                                                 Improved start) {
  const PartTask by_edges{by_map, task.candidates, task.options};
  try {
    start.solved.part = adjust_cleanly(by_edges, narrowed_to(by_map, part, start.solved.part.tags),
                                       start.solved.held_tag, start.solved.state);
    improve(by_edges, start.solved, start.cameras);
    return start;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

void improve_honestly(const PartTask& task, const Part& part, const Improvement& improve,
                      Observations& observations, AdjustedPart& solved, BetterCameras& cameras) {
  const Improved before{solved, cameras};
  improve(task, solved, cameras);
  if (most_difference_px(cameras.refined, before.cameras.refined) < kInconstantEdges_px) return;
  Observations by_map = task.observations;
  take_edges_from_map(before.solved.part.views, before.solved.state,
                      {task.options.corner_sigma_px, task.options.edge_end_correlation}, by_map);
  auto again = improved_by_edges_of_map(task, by_map, part, improve, before);
  if (!again || most_difference_px(cameras.refined, again->cameras.refined) < kInconstantEdges_px) return;
  observations.views = std::move(by_map.views);
  solved = std::move(again->solved);
  cameras = std::move(again->cameras);
}

}  // namespace apriltrack
