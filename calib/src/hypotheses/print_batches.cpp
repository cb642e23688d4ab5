#include "hypotheses/print_batches.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

#include "faults/tag_fit.h"
#include "model/corner_views.h"

namespace apriltrack {
namespace {

constexpr double kClearSigmas = 4.5;
constexpr std::size_t kMostTagsSized = 200;  // a dense system, whose best cut takes their cube
constexpr int kLeastAlike = 2;               // of one, find_odd_shape tells
constexpr double kPrintsDiffer = 0.05;  // of the size, standard deviation: keeps what no view tells near 0
constexpr double kLeastDifference = 0.008;  // of prints at one setting a few parts in a thousand are usual
// Of the squares that all sizes explain, what the two groups alone must. Cut in two, numbers of one normal
// distribution leave them 2 / pi, evenly spread ones 3 / 4.
constexpr double kClearlyTwo = 0.9;
constexpr double kClearlyTwoOfFew = 0.97, kFewTags = 6;  // chance leaves few numbers much
constexpr double kMoreThanOneTag = 10.0;  // of half the squares, beyond what one odd tag explains
constexpr double kWorthTurning = 1.0 + 1e-6;
// Of tags that are left out for their size: a quarter of all at least, and off alike to a fifth of it. Sizes
// that were mistyped are of any ratio; no setting of a printer is off by more than a seventh.
constexpr double kLeastShare = 0.25, kMostScatter = 0.2, kMostDifference = 0.15;

/// One parameter for the logarithm of the size of each of `tags`, in their order.
ParameterInformation information_of_sizes(const Observations& observations,
                                          const std::vector<std::size_t>& views, const MapState& state,
                                          const std::vector<int>& tags, const PoseInformation& poses) {
  constexpr Eigen::Index kNotAsked = -1;
  std::vector<Eigen::Index> index(observations.tags.size(), kNotAsked);
  for (std::size_t i = 0; i < tags.size(); ++i)
    index[static_cast<std::size_t>(tags[i])] = static_cast<Eigen::Index>(i);
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const TagView& view = observations.views[views[i]];
    const Eigen::Index first = index[static_cast<std::size_t>(view.tag)];
    if (first != kNotAsked)
      columns.push_back({i, residual_by_shape(observations, view, state).col(0), first});
  }
  return poses.eliminate_poses(columns);
}

/// With one size that all have in common free as well: a rig, whose baseline may be off, tells of it.
ParameterInformation without_common_size(ParameterInformation sizes) {
  constexpr double kTold = 1e-9;
  const Eigen::VectorXd follow = sizes.information.rowwise().sum();
  const double squares = follow.sum();
  if (squares < kTold * sizes.information.trace()) return sizes;
  sizes.gradient -= follow * (sizes.gradient.sum() / squares);
  for (auto& [tag, gradient] : sizes.gradient_by_errors)
    gradient -= (follow / squares * gradient.colwise().sum()).eval();
  sizes.information -= follow * follow.transpose() / squares;
  return sizes;
}

using Tags = Eigen::VectorXd;  ///< One for a tag that is among them, zero for another.

/// How well one number for the size of some tags, and another for that of the rest, explain what the sizes of
/// all of them do.
class Sizes {
 public:
  Sizes(const ParameterInformation& sizes, const ErrorScale& scale)
      : sizes_(sizes),
        noise_variance_(scale.noise_variance),
        gradient_covariance_(gradient_covariance(sizes, scale)) {}

  /// What of the squares of the residuals goes when all sizes are free, or one number for some of them.
  double explained_by_all() const { return -log_sizes(kPrintsDiffer).dot(sizes_.gradient); }
  double explained_by(const Tags& larger) const { return -log_ratio(larger) * larger.dot(sizes_.gradient); }
  double log_ratio(const Tags& larger) const {
    const double squares = squares_of(larger);
    return squares > 0.0 ? -larger.dot(sizes_.gradient) / squares : 0.0;
  }

  double explained_by_one() const {
    double most = 0.0;
    for (Eigen::Index tag = 0; tag < sizes_.gradient.size(); ++tag)
      most = std::max(most, explained_by(Tags::Unit(sizes_.gradient.size(), tag)));
    return most;
  }

  /// By noise, and by the errors that tags keep.
  double sigma(const Tags& larger) const {
    return std::sqrt(larger.dot(gradient_covariance_ * larger)) / squares_of(larger);
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
    system.diagonal().array() += noise_variance_ / (prior * prior);
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
    return log_ratio(best) < 0.0 ? Tags(Tags::Ones(best.size()) - best) : best;
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
  double noise_variance_;
  Eigen::MatrixXd gradient_covariance_;
};

bool is_clear(const Sizes& sizes, const Tags& larger, const ErrorScale& scale) {
  const auto num_tags = static_cast<double>(larger.size());
  const double by_chance = 2.0 / std::numbers::pi * num_tags;  // of normal numbers, by the best cut
  const double sigmas = std::sqrt(kClearSigmas * kClearSigmas + by_chance);
  const double ratio = sizes.log_ratio(larger), explained = sizes.explained_by(larger);
  return ratio > std::max(kLeastDifference, sigmas * sizes.sigma(larger)) &&
         explained > (num_tags < kFewTags ? kClearlyTwoOfFew : kClearlyTwo) * sizes.explained_by_all() &&
         explained - sizes.explained_by_one() > 2.0 * kMoreThanOneTag * scale.noise_variance;
}

}  // namespace

std::optional<PrintBatches> find_print_batches(const Observations& observations,
                                               const std::vector<std::size_t>& views, const MapState& state,
                                               const std::vector<int>& tags, const PoseInformation& poses,
                                               const ErrorScale& scale) {
  if (tags.size() < 2 * kLeastAlike || tags.size() > kMostTagsSized) return std::nullopt;
  const ParameterInformation information =
      without_common_size(information_of_sizes(observations, views, state, tags, poses));
  const Sizes sizes(information, scale);
  const Tags larger = sizes.best();
  if (!is_clear(sizes, larger, scale)) return std::nullopt;
  PrintBatches batches{{}, {}, sizes.log_ratio(larger), sizes.sigma(larger)};
  for (std::size_t i = 0; i < tags.size(); ++i)
    (larger[static_cast<Eigen::Index>(i)] > 0.0 ? batches.larger : batches.smaller)
        .push_back(observations.tags[static_cast<std::size_t>(tags[i])]);
  return batches;
}

std::optional<PrintBatches> print_batches_by(const std::vector<TagFinding>& findings,
                                             const Observations& observations, const std::vector<int>& rest) {
  std::vector<const TagFinding*> others;
  double mean = 0.0, squares = 0.0;
  for (const TagFinding& finding : findings) {
    if (finding.kind != TagFinding::Kind::kSize || !finding.is_left_out) continue;
    others.push_back(&finding);
    mean += finding.log_scale();
    squares += finding.log_scale() * finding.log_scale();
  }
  const auto num = static_cast<double>(others.size());
  if (num < kLeastAlike || num < kLeastShare * static_cast<double>(others.size() + rest.size()))
    return std::nullopt;
  mean /= num;
  const double scatter = std::sqrt(std::max(0.0, squares / num - mean * mean));
  if (std::abs(mean) < kLeastDifference || std::abs(mean) > kMostDifference) return std::nullopt;
  if (scatter > kMostScatter * std::abs(mean)) return std::nullopt;
  PrintBatches batches{{}, {}, std::abs(mean), scatter / std::sqrt(num)};
  std::vector<TagKey>& of_others = mean > 0.0 ? batches.larger : batches.smaller;
  std::vector<TagKey>& of_rest = mean > 0.0 ? batches.smaller : batches.larger;
  for (const TagFinding* other : others)
    of_others.push_back(observations.tags[static_cast<std::size_t>(other->tag)]);
  for (const int tag : rest) of_rest.push_back(observations.tags[static_cast<std::size_t>(tag)]);
  std::ranges::sort(of_others);
  return batches;
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

}  // namespace apriltrack
