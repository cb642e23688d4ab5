#include "hypotheses/honest_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "cameras/predicted_edges.h"
#include "model/corner_views.h"

namespace apriltrack {
namespace {

// Edges are no more constant than that: by the slower half of a hand-held recording they are found 0.14 px
// from where they are by the faster one (euroc_aprilgrid). What moves them less does not matter.
constexpr double kInconstantEdges_px = 0.1;

using EdgeOffsets = std::map<int, double>;  ///< By camera; one that is not estimated is 0.

/// Those of cameras that have none yet.
void take_offsets(const CameraRefinement& cameras, EdgeOffsets& offsets_px) {
  for (const EstimatedParameter& one : cameras.estimates)
    if (one.parameter.kind == CameraParameter::Kind::kEdgeOffset)
      offsets_px.emplace(one.parameter.camera, one.value);
}

/// Estimated, or left open. What is open of an estimated one is only what remains of it.
EdgeOffsets edge_offsets(const BetterCameras& cameras) {
  EdgeOffsets offsets_px;
  if (cameras.refined.is_accepted) take_offsets(cameras.refined, offsets_px);
  if (cameras.open) take_offsets(*cameras.open, offsets_px);
  return offsets_px;
}

bool differ(EdgeOffsets a, const EdgeOffsets& b) {
  for (const auto& [camera, offset_px] : b) a[camera] -= offset_px;
  return std::ranges::any_of(a, [](const auto& one) { return std::abs(one.second) >= kInconstantEdges_px; });
}

/// To first order, by the edges of `by_map`. Weights that follow errors may hide an offset, too.
EdgeOffsets edge_offsets_by(const Observations& by_map, const PartTask& task, const AdjustedPart& solved) {
  EdgeOffsets offsets_px;
  const auto edges = open_parameters(
      {by_map, task.candidates, task.options},
      edge_offset_parameters(cameras_of(by_map, solved.part), task.options.edge_offset_sigma_px), solved);
  if (edges) take_offsets(*edges, offsets_px);
  for (auto& [camera, offset_px] : offsets_px) {  // beside what the solution has of them
    const auto c = static_cast<std::size_t>(camera);
    offset_px += solved.state.cameras[c].edge_offset_px - by_map.cameras[c].edge_offset_px;
  }
  return offsets_px;
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
  Outcome<Part> kept = adjust_cleanly(by_edges, narrowed_to(by_map, part, start.solved.part.tags),
                                      start.solved.held_tag, start.solved.state);
  if (!kept) return std::nullopt;
  start.solved.part = std::move(*kept);
  try {
    improve(by_edges, start.solved, start.cameras);
    return start;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

void improve_honestly(const PartTask& task, const Part& part, const Improvement& improve,
                      Observations& observations, AdjustedPart& solved, BetterCameras& cameras) {
  if (!(task.options.edge_offset_sigma_px > 0.0)) return improve(task, solved, cameras);
  const Improved before{solved, cameras};
  improve(task, solved, cameras);
  Observations by_map = task.observations;
  take_edges_from_map(before.solved.part.views, before.solved.state,
                      {task.options.corner_sigma_px, task.options.edge_end_correlation}, by_map);
  const EdgeOffsets found = edge_offsets(cameras);
  if (!differ(found, edge_offsets(before.cameras)) && !differ(found, edge_offsets_by(by_map, task, solved)))
    return;
  auto again = improved_by_edges_of_map(task, by_map, part, improve, before);
  if (!again || !differ(found, edge_offsets(again->cameras))) return;
  observations.views = std::move(by_map.views);
  solved = std::move(again->solved);
  cameras = std::move(again->cameras);
}

}  // namespace apriltrack
