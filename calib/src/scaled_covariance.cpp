#include "scaled_covariance.h"

#include <algorithm>
#include <set>

#include "noise_correlation.h"

namespace apriltrack {
namespace {

// The expected sigma counts as this many residuals beside those of the fit, as in the localizer: many views
// speak for themselves, while a few, whose residuals may all be small by chance, claim no more than is known.
constexpr double kPriorStrength = 3.0;

/// Residuals beyond what the unknowns (each frame's pose, and the tags' but one) can make vanish.
double degrees_of_freedom(const std::vector<LinearView>& views) {
  std::set<int> tags, frames;
  double count = 0.0;
  for (const LinearView& view : views) {
    tags.insert(view.tag);
    frames.insert(view.frame);
    count += static_cast<double>(view.residual.size());
  }
  return count - 6.0 * (static_cast<double>(tags.size()) - 1.0) - 6.0 * static_cast<double>(frames.size());
}

}  // namespace

std::optional<std::vector<TagCovariance>> scaled_covariances(const std::vector<LinearView>& views,
                                                             const std::vector<int>& tags, int held_tag,
                                                             double bias_variance) {
  auto covariances = tag_covariances(views, tags, held_tag);
  if (!covariances) return std::nullopt;
  double squares = 0.0;
  for (const LinearView& view : views) squares += view.residual.squaredNorm();
  const double freedom = std::max(0.0, degrees_of_freedom(views));
  // In units of the expected variance: 1 when the residuals are as large as they were taken to be.
  const double variance =
      std::max(kMinScale * kMinScale, (kPriorStrength + squares) / (kPriorStrength + freedom));
  const double repetition = views_per_independent_view(views);
  for (TagCovariance& tag : *covariances) {
    tag.by_noise *= variance * repetition;
    tag.by_bias *= bias_variance;
  }
  return covariances;
}

}  // namespace apriltrack
