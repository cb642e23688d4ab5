#include "hypotheses/honest_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cameras/camera_refinement.h"
#include "cameras/predicted_edges.h"
#include "initialise/part_adjustment.h"

namespace apriltrack {
namespace {

// Edges are no more constant than that: by the slower half of a hand-held recording they are found 0.14 px
// from where they are by the faster one (euroc_aprilgrid). What moves them less does not matter.
constexpr double kInconstantEdges_px = 0.1;

/// How far from where `solved` has them, to first order; none where the views do not tell.
std::vector<double> edge_offsets_px(const PartTask& task, const AdjustedPart& solved) {
  std::vector<double> offsets_px;
  const auto edges = open_parameters(
      task,
      edge_offset_parameters(cameras_of(task.observations, solved.part), task.options.edge_offset_sigma_px),
      solved);
  if (!edges) return offsets_px;
  for (const EstimatedParameter& one : edges->estimates) offsets_px.push_back(one.value);
  return offsets_px;
}

bool differ(const std::vector<double>& a, const std::vector<double>& b) {
  return !std::ranges::equal(
      a, b, [](double one, double other) { return std::abs(one - other) < kInconstantEdges_px; });
}

}  // namespace

void take_honest_edges(const PartTask& task, const Part& part, Observations& observations,
                       AdjustedPart& solved) {
  if (!(task.options.edge_offset_sigma_px > 0.0)) return;
  Observations by_map = task.observations;
  take_edges_from_map(solved.part.views, solved.state,
                      {task.options.corner_sigma_px, task.options.edge_end_correlation}, by_map);
  const PartTask by_edges{by_map, task.candidates, task.options};
  if (!differ(edge_offsets_px(task, solved), edge_offsets_px(by_edges, solved))) return;
  MapState state = solved.state;
  Outcome<Part> kept =
      adjust_cleanly(by_edges, narrowed_to(by_map, part, solved.part.tags), solved.held_tag, state);
  if (!kept) return;
  observations.views = std::move(by_map.views);
  solved.part = std::move(*kept);
  solved.state = std::move(state);
}

}  // namespace apriltrack
