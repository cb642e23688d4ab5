#include "hypotheses/tag_hypotheses.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/spread_selection.h"
#include "numerics/upper_median.h"
#include "uncertainty/linear_part.h"

namespace apriltrack {
namespace {

constexpr std::size_t kLeastViewsOfTag = 4;  // a pose has six unknowns, a view tells eight

constexpr std::size_t kMostTagsAsked = 60;      // how large their errors are
constexpr double kMedianOfThree = 2.366 / 3.0;  // of the mean of three squared normal numbers
constexpr double kLeastBias = 1e-3;             // of the noise's variance, where none is expected
constexpr int kMostDoublings = 16;
constexpr double kSigmaOfMedian = 1.4826;  // of a normal distribution, over the median distance
// How tags differ in errors beyond the corners' own: 0.08 to 0.44 in six recordings, 0.27 in the median. That
// counts as if it were measured on so many tags.
constexpr double kUsualSpread = 0.27, kTagsOfUsualSpread = 10.0;

std::vector<double> mean_squares(const std::vector<std::optional<Score>>& scores, const ErrorScale& scale) {
  std::vector<double> values;
  for (const std::optional<Score>& score : scores)
    if (score) values.push_back(score->mean_square(scale));
  return values;
}

/// 0 of none.
double median(std::vector<double> values) {
  return values.empty() ? 0.0 : upper_median(std::move(values));
}

/// Standard deviation of the logarithms of the tags' mean squares, beyond what chance gives them.
double spread_of_tags(const std::vector<std::optional<Score>>& motions, const ErrorScale& scale) {
  std::vector<double> logs = mean_squares(motions, scale);
  if (logs.empty()) return 0.0;
  double by_chance = 0.0;
  for (const std::optional<Score>& score : motions)
    if (score) by_chance += 2.0 / static_cast<double>(score->gradient.size() - 6);
  for (double& value : logs) value = std::log(value);
  const double middle = median(logs);
  for (double& value : logs) value = std::abs(value - middle);
  const double sigma = kSigmaOfMedian * median(logs), num = static_cast<double>(logs.size());
  const double beyond_chance = std::max(0.0, sigma * sigma - by_chance / num);
  return std::sqrt((num * beyond_chance + kTagsOfUsualSpread * kUsualSpread * kUsualSpread) /
                   (num + kTagsOfUsualSpread));
}

using Ask = std::vector<TagHypothesis> (*)(const TagViews&);
constexpr Ask kFaults[] = {faults_of_shape, faults_of_motion, faults_of_identity};

}  // namespace

NullScale null_scale(const PartTask& task, const RobustMap& map, const ParallelFor& parallel) {
  std::vector<int> tags;
  for (const int tag : map.part.tags)
    if (map.views_of(tag).size() >= kLeastViewsOfTag) tags.push_back(tag);
  tags = spread_selection(tags, kMostTagsAsked);
  NullScale scale;
  std::vector<std::optional<Score>> shapes(tags.size()), motions(tags.size());
  parallel(tags.size(), [&](std::size_t i) {
    const TagViews views{task, map, scale, tags[i], map.views_of(tags[i])};
    shapes[i] = score_of_shape(views);
    motions[i] = score_of_motion(views);
  });
  ErrorScale& of_most = scale.of_most;
  of_most = {.noise_variance = 1.0, .bias_variance = expected_bias_variance(task.options)};
  of_most.noise_variance = std::max(1.0, median(mean_squares(motions, of_most)));
  for (int i = 0; i < kMostDoublings; ++i) {
    if (median(mean_squares(shapes, of_most)) < kMedianOfThree) break;
    of_most.bias_variance = std::max(2.0 * of_most.bias_variance, kLeastBias);
  }
  std::vector<double> moves;
  for (const std::optional<Score>& motion : motions)
    if (motion) moves.push_back(mean_square_of_moves(*motion, of_most));
  scale.lasting = std::max(1.0, median(std::move(moves)));
  // Tags differ in what is beyond the corners' own noise.
  scale.spread = spread_of_tags(motions, of_most) * (1.0 - 1.0 / of_most.noise_variance);
  return scale;
}

std::optional<TagHypothesis> likeliest_fault(const PartTask& task, const RobustMap& map,
                                             const NullScale& scale, int tag) {
  const TagViews views{task, map, scale, tag, map.views_of(tag)};
  if (views.views.size() < kLeastViewsOfTag) return std::nullopt;
  std::optional<TagHypothesis> best;
  for (const Ask ask : kFaults)
    for (TagHypothesis& fault : ask(views))
      if (!best || fault.evidence.log_odds > best->evidence.log_odds) best = std::move(fault);
  if (!best) return std::nullopt;
  best->tag = tag;
  for (const std::size_t i : views.views) best->views.push_back(map.index[i]);
  return best;
}

}  // namespace apriltrack
