#include "faults/pliant_frames.h"

#include <algorithm>

#include "solve/frame_views.h"

namespace apriltrack {
namespace {

// Of the usual cost of a view: it seems far off; and it is explained.
constexpr double kFarInUsualCosts = 4.0, kExplained = 2.0;

/// What the view costs beside the others of its frame, which may take any pose.
double cost_beside_others(const PartTask& task, MapState& state, const ProbeView& probe) {
  const auto& views = task.observations.views;
  std::vector<std::size_t> all = probe.others;
  FrameViews others(task, probe.others, state);
  others.pose() = probe.T_map_rig;
  const double of_others = others.cost();
  all.push_back(static_cast<std::size_t>(probe.view - views.data()));
  FrameViews together(task, std::move(all), state);
  const double elsewhere = together.best_of_proposals().first;
  return std::min(elsewhere, together.settle()) - of_others;
}

}  // namespace

std::vector<ProbeView> without_pliant_frames(const PartTask& task, const AdjustedPart& solved,
                                             const std::vector<ProbeView>& probes, const TagFit& one) {
  MapState state = solved.state;
  state.noise.of_view.clear();
  std::vector<ProbeView> witnesses = probes;
  std::erase_if(witnesses, [&](const ProbeView& probe) {
    if (probe_cost(probe, one.T_map_tag, one.shape) < kFarInUsualCosts * usual_probe_cost() * probe.share)
      return false;
    state.T_map_tag[static_cast<std::size_t>(probe.view->tag)] = one.T_map_tag;
    return cost_beside_others(task, state, probe) < kExplained * usual_probe_cost();
  });
  return witnesses;
}

}  // namespace apriltrack
