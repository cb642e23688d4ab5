#include "model/corner_views.h"

#include "model/view_residual.h"

namespace apriltrack {

std::vector<LinearView> corner_views(const Observations& observations, const std::vector<std::size_t>& views,
                                     const MapState& state) {
  std::vector<LinearView> linear;
  linear.reserve(views.size());
  for (const std::size_t v : views) {
    const TagView& view = observations.views[v];
    Vector8d residual_px;
    Matrix8x6d by_rig, by_tag;
    if (!residual_of(observations, view, state, &residual_px, &by_rig, &by_tag)) continue;
    const Vector8d weights = noise_weights(view, state);
    const Matrix8d W = weights.asDiagonal() * view.whitening;
    linear.push_back({view.tag, view.frame, view.camera, W.lazyProduct(residual_px), W.lazyProduct(by_rig),
                      W.lazyProduct(by_tag),
                      Matrix8d(view.kept_share * weights.asDiagonal() * view.by_model_errors)});
  }
  return linear;
}

}  // namespace apriltrack
