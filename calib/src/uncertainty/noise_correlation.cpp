#include "uncertainty/noise_correlation.h"

#include <algorithm>
#include <map>
#include <utility>

namespace apriltrack {
namespace {

constexpr std::size_t kMaxLag = 200;
constexpr std::size_t kLeastViewsForMean = 8;
constexpr double kNoCorrelation = 0.05;  // below, what is left is chance or the fit's own doing

/// Residuals of one tag in one camera, in the order of time.
using Series = std::vector<LinearView::Residual>;

std::map<std::pair<int, int>, Series> residual_series(const std::vector<LinearView>& views) {
  std::map<std::pair<int, int>, Series> series;
  for (const LinearView& view : views) series[{view.tag, view.camera}].push_back(view.residual);
  return series;
}

/// What a tag keeps in all of its views is no noise, and counted elsewhere.
void take_out_mean(Series& series) {
  if (series.size() < kLeastViewsForMean) return;  // most of the noise would go with it
  LinearView::Residual sum = LinearView::Residual::Zero(series.front().size());
  for (const auto& residual : series) sum += residual;
  const LinearView::Residual mean = sum / static_cast<double>(series.size());
  for (auto& residual : series) residual -= mean;
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

double views_per_independent_view(const std::vector<LinearView>& views) {
  auto series = residual_series(views);
  for (auto& [key, of_tag] : series) take_out_mean(of_tag);
  double sum = 1.0;
  for (std::size_t lag = 1; lag <= kMaxLag; ++lag) {
    const double correlation = autocorrelation(series, lag);
    if (correlation < kNoCorrelation) break;
    sum += 2.0 * correlation;
  }
  return sum;
}

}  // namespace apriltrack
