#include "cameras/predicted_edges.h"

namespace apriltrack {

void take_edges_from_map(const std::vector<std::size_t>& views, const MapState& state, const EdgeNoise& noise,
                         Observations& observations) {
  for (const std::size_t v : views) {
    TagView& view = observations.views[v];
    Vector8d residual_px;
    if (!residual_of(observations, view, state, &residual_px)) continue;
    CornersPx corners_px = view.corners_px;
    for (int corner = 0; corner < kNumCorners; ++corner)
      corners_px[static_cast<std::size_t>(corner)] += residual_px.segment<2>(2 * corner);
    if (!is_quad_of_tag(corners_px)) continue;
    view.set_noise(corners_px, noise);
  }
}

}  // namespace apriltrack
