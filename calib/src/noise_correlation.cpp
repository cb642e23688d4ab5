#include "noise_correlation.h"

#include <algorithm>
#include <map>

#include "view_residual.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMaxLag = 200;
constexpr double kNoCorrelation = 0.05;  // below, what is left is chance or the fit's own doing

/// Whitened residuals of one tag in one camera, in the order of time.
using Series = std::vector<Vector8d>;

std::map<std::pair<int, int>, Series> residual_series(const Observations& observations, const Part& part,
                                                      const MapState& state) {
  std::map<std::pair<int, int>, Series> series;
  for (const std::size_t v : part.views) {
    const TagView& view = observations.views[v];
    Vector8d residual_px;
    if (view_residual(observations.cameras[static_cast<std::size_t>(view.camera)],
                      observations.sizes_m[static_cast<std::size_t>(view.tag)], view.corners_px,
                      state.T_map_rig[static_cast<std::size_t>(view.frame)],
                      state.T_map_tag[static_cast<std::size_t>(view.tag)], &residual_px, nullptr, nullptr))
      series[{view.tag, view.camera}].push_back(view.whitening * residual_px);
  }
  return series;
}

double autocorrelation(const std::map<std::pair<int, int>, Series>& all, std::size_t lag) {
  double products = 0.0, squares = 0.0;
  for (const auto& [key, series] : all) {
    for (std::size_t i = 0; i + lag < series.size(); ++i) {
      products += series[i].dot(series[i + lag]);
      squares += 0.5 * (series[i].squaredNorm() + series[i + lag].squaredNorm());
    }
  }
  return squares > 0.0 ? products / squares : 0.0;
}

}  // namespace

double views_per_independent_view(const Observations& observations, const Part& part, const MapState& state) {
  const auto series = residual_series(observations, part, state);
  double sum = 1.0;
  for (std::size_t lag = 1; lag <= kMaxLag; ++lag) {
    const double correlation = autocorrelation(series, lag);
    if (correlation < kNoCorrelation) break;
    sum += 2.0 * correlation;
  }
  return sum;
}

}  // namespace apriltrack
