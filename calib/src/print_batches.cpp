#include "print_batches.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "corner_views.h"
#include "tag_fit.h"

namespace apriltrack {
namespace {

constexpr std::size_t kMostTagsSized = 200;
constexpr int kLeastAlike = 2;
constexpr double kPrintsDiffer = 0.05;  // of the size, standard deviation: keeps what no view tells near 0
constexpr double kLeastDifference = 0.008;
constexpr double kClearlyDifferent = 4.5;  // standard deviations
// Of the squares that all sizes explain, what the two groups alone must. Cut in two, numbers of one normal
// distribution leave them 2 / pi, evenly spread ones 3 / 4.
constexpr double kClearlyTwo = 0.9;
constexpr double kWorthTurning = 1.0 + 1e-6;

/// One parameter for the logarithm of the size of each of `tags`, in their order.
ParameterInformation information_of_sizes(const Observations& observations,
                                          const std::vector<std::size_t>& views, const MapState& state,
                                          const std::vector<int>& tags, const PoseInformation& poses) {
  std::vector<Eigen::Index> index(observations.tags.size(), 0);
  for (std::size_t i = 0; i < tags.size(); ++i)
    index[static_cast<std::size_t>(tags[i])] = static_cast<Eigen::Index>(i);
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const TagView& view = observations.views[views[i]];
    columns.push_back(
        {i, residual_by_shape(observations, view, state).col(0), index[static_cast<std::size_t>(view.tag)]});
  }
  return poses.eliminate_poses(columns);
}

using Tags = Eigen::VectorXd;  ///< One for a tag that is among them, zero for another.

/// How well one number for the size of some tags, and another for that of the rest, explain what the sizes of
/// all of them do.
class Sizes {
 public:
  Sizes(const ParameterInformation& sizes, const ErrorScale& scale) : sizes_(sizes), scale_(scale) {}

  /// Of half the squares twice, and so of the others.
  double explained_by_all() const { return -log_sizes(kPrintsDiffer).dot(sizes_.gradient); }
  double explained_by(const Tags& larger) const { return -log_ratio(larger) * larger.dot(sizes_.gradient); }
  double log_ratio(const Tags& larger) const {
    const double squares = squares_of(larger);
    return squares > 0.0 ? -larger.dot(sizes_.gradient) / squares : 0.0;
  }

  /// By noise, and by the errors that tags keep.
  double sigma(const Tags& larger) const {
    const double squares = squares_of(larger);
    double spread = scale_.noise_variance * squares;
    for (const auto& [tag, gradient] : sizes_.gradient_by_errors)
      spread += scale_.bias_variance * (larger.transpose() * gradient).squaredNorm();
    return std::sqrt(spread) / squares;
  }

  /// Those that explain most: from cuts in the order of the sizes, tag by tag. What is left undetermined of
  /// sizes disturbs their order, so that it is asked for with weaker and stronger priors.
  Tags best() const {
    Tags best = Tags::Zero(sizes_.gradient.size());
    for (const double prior : {kPrintsDiffer, 0.1 * kPrintsDiffer, 0.01 * kPrintsDiffer}) {
      Tags found = improved(best_cut(log_sizes(prior)));
      if (explained_by(found) > explained_by(best)) best = std::move(found);
    }
    return best;
  }

 private:
  double squares_of(const Tags& larger) const { return larger.dot(sizes_.information * larger); }

  /// prior: their standard deviation.
  Eigen::VectorXd log_sizes(double prior) const {
    Eigen::MatrixXd system = sizes_.information;
    system.diagonal().array() += scale_.noise_variance / (prior * prior);
    return -system.ldlt().solve(sizes_.gradient);
  }

  static bool are_enough_alike(const Tags& larger) {
    const double num = larger.sum();
    return num >= kLeastAlike && static_cast<double>(larger.size()) - num >= kLeastAlike;
  }

  Tags best_cut(const Eigen::VectorXd& log_sizes) const {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(log_sizes.size()));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::ranges::sort(order, std::greater{}, [&](Eigen::Index tag) { return log_sizes[tag]; });
    Tags larger = Tags::Zero(log_sizes.size()), best = larger;
    for (const Eigen::Index tag : order) {
      larger[tag] = 1.0;
      if (are_enough_alike(larger) && explained_by(larger) > explained_by(best)) best = larger;
    }
    return best;
  }

  /// Turns one tag after the other, as long as that explains more.
  Tags improved(Tags larger) const {
    for (bool is_better = true; is_better;) {
      is_better = false;
      for (Eigen::Index tag = 0; tag < larger.size(); ++tag) {
        Tags turned = larger;
        turned[tag] = 1.0 - turned[tag];
        if (!are_enough_alike(turned) || log_ratio(turned) <= 0.0 ||
            explained_by(turned) <= explained_by(larger) * kWorthTurning)
          continue;
        larger = std::move(turned);
        is_better = true;
      }
    }
    return larger;
  }

  const ParameterInformation& sizes_;
  const ErrorScale& scale_;
};

}  // namespace

std::optional<PrintBatches> find_print_batches(const Observations& observations,
                                               const std::vector<std::size_t>& views, const MapState& state,
                                               const std::vector<int>& tags, const PoseInformation& poses,
                                               const ErrorScale& scale) {
  if (tags.size() < 2 * kLeastAlike || tags.size() > kMostTagsSized) return std::nullopt;
  const ParameterInformation information = information_of_sizes(observations, views, state, tags, poses);
  const Sizes sizes(information, scale);
  const Tags larger = sizes.best();
  PrintBatches batches;
  batches.log_ratio = sizes.log_ratio(larger);
  if (batches.log_ratio < kLeastDifference) return std::nullopt;
  batches.sigma = sizes.sigma(larger);
  if (batches.log_ratio < kClearlyDifferent * batches.sigma ||
      sizes.explained_by(larger) < kClearlyTwo * sizes.explained_by_all())
    return std::nullopt;
  batches.explained = 0.5 * sizes.explained_by(larger) / scale.noise_variance;
  for (std::size_t i = 0; i < tags.size(); ++i)
    (larger[static_cast<Eigen::Index>(i)] > 0.0 ? batches.larger : batches.smaller)
        .push_back(observations.tags[static_cast<std::size_t>(tags[i])]);
  return batches;
}

std::optional<PrintBatches> find_print_batches(const PartTask& task, const AdjustedPart& solved) {
  const Part& part = solved.part;
  const std::vector<LinearView> views = corner_views(task.observations, part.views, solved.state);
  const auto poses = PoseInformation::of(views, part.tags, solved.held_tag);
  if (!poses || views.size() != part.views.size()) return std::nullopt;
  const double bias = task.options.corner_bias_px / task.options.corner_sigma_px;
  return find_print_batches(task.observations, part.views, solved.state, part.tags, *poses,
                            error_scale(views, *poses, bias * bias));
}

std::vector<ParameterView> size_errors(const Observations& observations,
                                       const std::vector<std::size_t>& views, const MapState& state,
                                       const PrintBatches& batches) {
  std::vector<Eigen::RowVector2d> by_error;
  for (const TagKey& key : observations.tags) {
    const auto is_among = [&](const std::vector<TagKey>& print) {
      return std::ranges::find(print, key) != print.end();
    };
    by_error.emplace_back(is_among(batches.larger) ? batches.log_ratio : 0.0,
                          is_among(batches.smaller) ? batches.log_ratio : 0.0);
  }
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const TagView& view = observations.views[views[i]];
    columns.push_back({i, residual_by_shape(observations, view, state).col(0) *
                              by_error[static_cast<std::size_t>(view.tag)]});
  }
  return columns;
}

std::string words_of(const PrintBatches& batches) {
  return fmt::format(
      "the tags look like two prints of different size: {} are {:.1f} % (sigma {:.1f}) larger, beside their "
      "stated sizes, than {}. Measure a tag of each, and state both by --tag-sizes: the map is in between, "
      "and its covariances count that either may be as stated",
      list_tags(batches.larger), 100.0 * std::expm1(batches.log_ratio), 100.0 * batches.sigma,
      list_tags(batches.smaller));
}

}  // namespace apriltrack
