#include "hypotheses/robust_map.h"

#include <cmath>
#include <utility>

#include "model/corner_views.h"
#include "numerics/cauchy_loss.h"

namespace apriltrack {

RobustMap::RobustMap(const PartTask& task, Part offered, int held_tag, MapState near)
    : part(std::move(offered)), state(std::move(near)) {
  if (settle_robustly(task, part, held_tag, state)) return;
  for (const std::size_t v : part.views) {
    std::vector<LinearView> one = corner_views(task.observations, {v}, state);
    if (one.empty()) continue;  // it cannot be projected
    LinearView& view = one.front();
    const double root = std::sqrt(CauchyLoss{kRobustLoss}.weight(view.residual.squaredNorm()));
    view.residual *= root;
    view.by_rig *= root;
    view.by_tag *= root;
    view.by_error *= root;
    views.push_back(std::move(view));
    index.push_back(v);
    root_weights.push_back(root);
  }
  poses = PoseInformation::of(views, part.tags, held_tag);
  if (poses) poses->invert();
}

std::vector<std::size_t> RobustMap::views_of(int tag) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (views[i].tag == tag) result.push_back(i);
  return result;
}

}  // namespace apriltrack
