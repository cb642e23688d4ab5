#include "corner_views.h"

#include "view_residual.h"

namespace apriltrack {

std::vector<LinearView> corner_views(const Observations& observations, const std::vector<std::size_t>& views,
                                     const MapState& state) {
  std::vector<LinearView> linear;
  linear.reserve(views.size());
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    Vector8d residual_px;
    Matrix8x6d by_rig, by_tag;
    if (!view_residual(observations.cameras[static_cast<std::size_t>(view.camera)],
                       observations.sizes_m[static_cast<std::size_t>(view.tag)], view.corners_px,
                       state.T_map_rig[static_cast<std::size_t>(view.frame)],
                       state.T_map_tag[static_cast<std::size_t>(view.tag)], &residual_px, &by_rig, &by_tag))
      continue;
    linear.push_back({view.tag, view.frame, view.camera, view.whitening * residual_px,
                      view.whitening * by_rig, view.whitening * by_tag, Matrix8d::Identity()});
  }
  return linear;
}

}  // namespace apriltrack
