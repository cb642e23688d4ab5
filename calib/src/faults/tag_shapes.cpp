#include "faults/tag_shapes.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "faults/view_spread.h"
#include "model/corner_views.h"
#include "uncertainty/linear_part.h"

namespace apriltrack {
namespace {

constexpr double kMostMisshapen = 1.0 / 3.0;  // more of them, and it is the lens that is wrong
constexpr std::size_t kMostTagsShaped = 200;  // the system is solved anew for each
constexpr double kMedianOfNormal = 0.6745;    // of the sizes of standard normal numbers
constexpr double kMedianOfThree = 1.538;      // of the lengths of three of them
constexpr double kClearBeyondSize = 2.5;      // of the lengths of two: 1 of 23 sound tags are beyond

bool exceeds(double value, double sigma, double least) {
  return std::abs(value) > std::max(least, kClearSigmas * sigma);
}

/// One tag's, from what is left of the normal equations of its shape.
struct ShapeEstimate {
  int tag = 0;
  TagFit scaled, bent;
  /// Half the squares they explain, in units of the noise; of a side: that it alone is off.
  double gain_of_size = 0.0, gain_of_side = 0.0, gain_of_bend = 0.0;
  double sigmas = 0.0, sigmas_beyond_size = 0.0;  ///< Of all three numbers together, and of two.
  bool may_be_bent = true;

  bool is_size_clear() const { return exceeds(scaled.shape.log_scale, scaled.scale_sigma, kClearScale); }
  bool is_bend_clear() const { return bent.is_aspect_clear || bent.is_twist_clear; }
  bool is_clear() const { return is_size_clear() || is_bend_clear(); }
  /// As many unknowns, and a better explanation.
  bool is_one_side() const {
    return is_size_clear() && bent.aspect_sigma > 0.0 && gain_of_side > gain_of_size + kLikelierSide;
  }
  /// Unknowns that a bend has beside the size must pay for themselves.
  bool is_bend_likelier() const {
    return (may_be_bent && is_one_side()) ||
           (is_bend_clear() && (!is_size_clear() || gain_of_bend - 2.0 * kFeeOfUnknown > gain_of_size));
  }
  double gain() const { return is_bend_likelier() ? gain_of_bend : gain_of_size; }
};

/// How the tag's views, linearised, depend on the three numbers of its shape.
std::vector<ParameterView> shape_columns(const PartTask& task, const AdjustedPart& solved, int tag) {
  std::vector<ParameterView> columns;
  for (std::size_t i = 0; i < solved.part.views.size(); ++i) {
    const TagView& view = task.observations.views[solved.part.views[i]];
    if (view.tag == tag) columns.push_back({i, residual_by_shape(task.observations, view, solved.state)});
  }
  return columns;
}

ShapeEstimate estimate_shape(const ParameterInformation& of_shape, const ErrorScale& scale, double size_m) {
  const Eigen::Matrix3d information = of_shape.information, spread = gradient_covariance(of_shape, scale);
  const Eigen::Vector3d gradient = of_shape.gradient;
  ShapeEstimate result;
  TagShape& scaled = result.scaled.shape;
  scaled.size_m = size_m;
  scaled.log_scale = -gradient[0] / information(0, 0);
  result.scaled.scale_sigma = std::sqrt(spread(0, 0)) / information(0, 0);
  result.gain_of_size = -0.5 * gradient[0] * scaled.log_scale / scale.noise_variance;
  for (const double aspect : {2.0, -2.0}) {  // by the scale: of the width, of the height
    const Eigen::Vector3d side(1.0, aspect, 0.0);
    const double along = gradient.dot(side), squares = side.dot(information * side);
    if (squares > 0.0)
      result.gain_of_side =
          std::max(result.gain_of_side, 0.5 * along * along / squares / scale.noise_variance);
  }

  const Eigen::FullPivLU<Eigen::Matrix3d> factor(information);
  if (!factor.isInvertible()) return result;
  const Eigen::Matrix3d inverse = factor.inverse();
  const Eigen::Vector3d value = -inverse * gradient;
  const Eigen::Vector3d sigma = (inverse * spread * inverse).diagonal().cwiseMax(0.0).cwiseSqrt();
  TagFit& bent = result.bent;
  bent.shape = {size_m, value[0], value[1], value[2]};
  bent.scale_sigma = sigma[0];
  bent.aspect_sigma = sigma[1];
  bent.twist_sigma = sigma[2];
  result.gain_of_bend = -0.5 * gradient.dot(value) / scale.noise_variance;
  // Optimal, unlike the numbers themselves, also where errors that the tag keeps outweigh the noise.
  const double all = gradient.dot(spread.ldlt().solve(gradient));
  result.sigmas = std::sqrt(std::max(0.0, all));
  result.sigmas_beyond_size = std::sqrt(std::max(0.0, all - gradient[0] * gradient[0] / spread(0, 0)));
  return result;
}

std::vector<ShapeEstimate> estimate_shapes(const PartTask& task, const AdjustedPart& solved) {
  std::vector<ShapeEstimate> result;
  if (solved.part.tags.size() > kMostTagsShaped) return result;
  const LinearPart linear(task, solved.state, solved.part, solved.held_tag);
  if (!linear.poses) return result;
  for (const int tag : solved.part.tags) {
    const ParameterInformation of_shape = linear.poses->eliminate_poses(shape_columns(task, solved, tag));
    if (!(of_shape.information(0, 0) > 0.0)) continue;
    result.push_back(
        estimate_shape(of_shape, linear.scale, task.observations.sizes_m[static_cast<std::size_t>(tag)]));
    result.back().tag = tag;
    result.back().may_be_bent =
        !is_seen_from_one_side(task.observations, solved.part.views, solved.state, tag);
  }
  return result;
}

using ShapeNumber = std::pair<double, double*>;  ///< A value, and its sigma.

double size_in_sigmas(const ShapeNumber& one) {
  return std::abs(one.first) / *one.second;
}

/// How much larger than their sigmas the numbers of other tags typically are; at least 1.
double typical_of_others(const std::vector<ShapeNumber>& numbers, std::size_t own) {
  std::vector<double> others;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i != own && *numbers[i].second > 0.0) others.push_back(size_in_sigmas(numbers[i]));
  }
  if (others.empty()) return 1.0;
  std::ranges::sort(others);
  const double median = 0.5 * (others[(others.size() - 1) / 2] + others[others.size() / 2]);
  return std::max(1.0, median / kMedianOfNormal);
}

void widen_by_others(const std::vector<ShapeNumber>& numbers) {
  std::vector<double> factors;
  for (std::size_t i = 0; i < numbers.size(); ++i) factors.push_back(typical_of_others(numbers, i));
  for (std::size_t i = 0; i < numbers.size(); ++i) *numbers[i].second *= factors[i];
}

/// By the lengths of three numbers.
void widen_by_others(std::vector<ShapeEstimate>& shapes) {
  std::vector<double> lengths;
  for (const ShapeEstimate& one : shapes)
    if (one.sigmas > 0.0) lengths.push_back(one.sigmas);
  if (lengths.size() < 2) return;
  std::ranges::sort(lengths);
  const double typical = std::max(1.0, lengths[lengths.size() / 2] / kMedianOfThree);
  for (ShapeEstimate& one : shapes) {
    one.sigmas /= typical;
    one.sigmas_beyond_size /= typical;
  }
}

/// A bend that no number shows by itself: the views may tell well only what their sum is. Three normal
/// numbers are as long once in 7,000 times.
void judge_together(ShapeEstimate& one) {
  TagFit& bent = one.bent;
  if (one.is_clear() || one.sigmas < kClearSigmas || one.sigmas_beyond_size < kClearBeyondSize) return;
  const bool is_twist =
      std::abs(bent.shape.twist) * bent.aspect_sigma > std::abs(bent.shape.aspect) * bent.twist_sigma;
  bent.is_twist_clear = is_twist && std::abs(bent.shape.twist) > kClearBend;
  bent.is_aspect_clear = !is_twist && std::abs(bent.shape.aspect) > kClearBend;
  bent.is_clear_together = true;
}

/// What the lens or the detector does to all tags, and sigmas do not tell, shows in the others: a tag is odd
/// only where they are as stated.
void compare_with_others(std::vector<ShapeEstimate>& shapes) {
  std::vector<ShapeNumber> sizes, aspects, twists;
  for (ShapeEstimate& one : shapes) {
    sizes.emplace_back(one.scaled.shape.log_scale, &one.scaled.scale_sigma);
    aspects.emplace_back(one.bent.shape.aspect, &one.bent.aspect_sigma);
    twists.emplace_back(one.bent.shape.twist, &one.bent.twist_sigma);
  }
  for (auto* numbers : {&sizes, &aspects, &twists}) widen_by_others(*numbers);
  widen_by_others(shapes);
  for (ShapeEstimate& one : shapes) {
    TagFit& bent = one.bent;
    bent.is_aspect_clear = exceeds(bent.shape.aspect, bent.aspect_sigma, kClearBend);
    bent.is_twist_clear = exceeds(bent.shape.twist, bent.twist_sigma, kClearBend);
    judge_together(one);
    bent.is_aspect_clear = bent.is_aspect_clear || one.is_one_side();
    if (!one.may_be_bent) bent.is_aspect_clear = bent.is_twist_clear = false;
  }
}

TagFinding to_finding(const ShapeEstimate& one) {
  if (one.is_bend_likelier())
    return {.tag = one.tag,
            .kind = TagFinding::Kind::kNotFlat,
            .shape = shape_error_of(one.bent),
            .explained = one.gain_of_bend - 3.0 * kFeeOfUnknown};
  return {.tag = one.tag,
          .kind = TagFinding::Kind::kSize,
          .shape = shape_error_of(one.scaled),
          .is_left_out = true,
          .explained = one.gain_of_size - kFeeOfUnknown};
}

}  // namespace

std::optional<TagFinding> find_odd_shape(const PartTask& task, const AdjustedPart& solved) {
  std::vector<ShapeEstimate> shapes = estimate_shapes(task, solved);
  compare_with_others(shapes);
  const double num_tags = static_cast<double>(shapes.size());
  std::erase_if(shapes, [](const ShapeEstimate& one) { return !one.is_clear(); });
  if (shapes.empty() || static_cast<double>(shapes.size()) > kMostMisshapen * num_tags) return std::nullopt;
  return to_finding(*std::ranges::max_element(shapes, {}, &ShapeEstimate::gain));
}

}  // namespace apriltrack
