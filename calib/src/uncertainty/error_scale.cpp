#include "uncertainty/error_scale.h"

#include <algorithm>
#include <map>
#include <set>

#include "uncertainty/block_scatter.h"
#include "uncertainty/noise_correlation.h"

namespace apriltrack {
namespace {

// The expected sigma counts as this many residuals beside those of the fit, as in the localizer: many views
// speak for themselves, while a few, whose residuals may all be small by chance, claim no more than is known.
constexpr double kNoisePriorStrength = 3.0;
constexpr double kBiasPriorStrength = 16.0;        // numbers: two tags' worth
constexpr std::size_t kMostTagsOfKeptErrors = 60;  // are asked what they keep
constexpr std::size_t kLeastViewsOfKeptError = 5;

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

double residual_variance(const std::vector<LinearView>& views) {
  double squares = 0.0;
  for (const LinearView& view : views) squares += view.residual.squaredNorm();
  const double freedom = std::max(0.0, degrees_of_freedom(views));
  return std::max(kMinScale * kMinScale, (kNoisePriorStrength + squares) / (kNoisePriorStrength + freedom));
}

/// Views of one tag, in the order of time.
std::map<int, std::vector<const LinearView*>> by_tag(const std::vector<LinearView>& views) {
  std::map<int, std::vector<const LinearView*>> tags;
  for (const LinearView& view : views) tags[view.tag].push_back(&view);
  return tags;
}

/// What the fit leaves of the errors that a tag keeps, in the mean of its residuals.
Eigen::MatrixXd mean_by_errors(const std::vector<const LinearView*>& views, const PoseInformation& poses) {
  const int tag = views.front()->tag;
  const Eigen::MatrixXd by_errors = poses.poses_by_errors(tag);
  const auto offset = poses.offset_of(tag);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(views.front()->residual.size(), 8);
  for (const LinearView* view : views) {
    sum += view->by_error + view->by_rig * poses.frame_by_errors(view->frame, tag, by_errors);
    if (offset) sum += view->by_tag * by_errors.middleRows<6>(*offset);
  }
  return sum / static_cast<double>(views.size());
}

/// noise_variance: of one view, by how many neighbours repeat it.
double bias_variance(const std::vector<LinearView>& views, const PoseInformation& poses,
                     double noise_variance, double expected) {
  const auto tags = by_tag(views);
  const std::size_t step =
      std::max<std::size_t>(1, (tags.size() + kMostTagsOfKeptErrors - 1) / kMostTagsOfKeptErrors);
  double squares = kBiasPriorStrength * expected, count = kBiasPriorStrength;
  std::size_t rank = 0;
  for (const auto& [tag, of_tag] : tags) {
    if (rank++ % step != 0 || of_tag.size() < kLeastViewsOfKeptError) continue;
    LinearView::Residual mean = LinearView::Residual::Zero(of_tag.front()->residual.size());
    for (const LinearView* view : of_tag) mean += view->residual;
    mean /= static_cast<double>(of_tag.size());
    // The fit hides the noise of a mean as it hides what the tag keeps.
    const double visible = mean_by_errors(of_tag, poses).squaredNorm();
    const double by_noise = noise_variance * visible / static_cast<double>(of_tag.size());
    squares += mean.squaredNorm() - by_noise;
    count += visible;
  }
  return std::max(expected, squares / count);
}

}  // namespace

ErrorScale error_scale(const std::vector<LinearView>& views, const PoseInformation& poses,
                       double expected_bias_variance) {
  ErrorScale scale;
  scale.views_per_independent_view = views_per_independent_view(views);
  scale.noise_variance = residual_variance(views) * scale.views_per_independent_view;
  if (expected_bias_variance > 0.0)
    scale.bias_variance = bias_variance(views, poses, scale.noise_variance, expected_bias_variance);
  const double factor = BlockScatter(views, poses).tags_factor(scale.noise_variance);
  scale.views_per_independent_view *= factor;
  scale.noise_variance *= factor;
  return scale;
}

Eigen::MatrixXd gradient_covariance(const ParameterInformation& parameters, const ErrorScale& scale) {
  Eigen::MatrixXd covariance = scale.noise_variance * parameters.information;
  for (const auto& [tag, gradient] : parameters.gradient_by_errors)
    covariance += scale.bias_variance * gradient * gradient.transpose();
  return covariance;
}

}  // namespace apriltrack
