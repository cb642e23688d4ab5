#include "assess/halves.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "apriltrack/calib/calibration_options.h"
#include "apriltrack/calib/cross_validation.h"
#include "apriltrack/calib/joint_covariance.h"
#include "model/corner_views.h"
#include "solution/errors_of_part.h"
#include "solve/bundle_adjustment.h"
#include "uncertainty/joint_tag_covariance.h"

namespace apriltrack {
namespace {

constexpr std::size_t kBlocksOfHalves = 20;
constexpr std::size_t kLeastOfBlock = 5;  // moments: neighbours repeat their errors
constexpr std::size_t kLeastMomentsToHalve = 20;

struct Half {
  Part part;
  MapState state;
  // Of all tags of the part; rows of those that the half does not have are zero:
  JointCovariance joint;
  Eigen::MatrixXd by_taken;  ///< Independent errors of variance one of what both take as the whole has it.
};

std::vector<int> moments_of(const Observations& observations, const std::vector<std::size_t>& views) {
  std::set<int> frames;
  for (const std::size_t v : views) frames.insert(observations.views[v].frame);
  std::vector<int> by_time(frames.begin(), frames.end());
  std::ranges::stable_sort(by_time, {},
                           [&](int frame) { return observations.frames[static_cast<std::size_t>(frame)]; });
  return by_time;
}

/// The views of every other block of moments.
std::array<std::vector<std::size_t>, 2> split_by_blocks(const Observations& observations,
                                                        const std::vector<std::size_t>& views) {
  const std::vector<int> moments = moments_of(observations, views);
  const std::size_t length =
      std::max(kLeastOfBlock, (moments.size() + kBlocksOfHalves - 1) / kBlocksOfHalves);
  std::map<int, std::size_t> half_of;
  for (std::size_t i = 0; i < moments.size(); ++i) half_of[moments[i]] = i / length % 2;
  std::array<std::vector<std::size_t>, 2> halves;
  for (const std::size_t v : views) halves[half_of.at(observations.views[v].frame)].push_back(v);
  return halves;
}

/// The held tag if both halves tie it to others, else the tag that has most views in the half that shows it
/// less.
std::optional<int> common_tag(const Observations& observations, const PartSolution& solution,
                              const std::array<std::vector<std::size_t>, 2>& views) {
  std::array<std::map<int, int>, 2> counts;
  for (std::size_t h = 0; h < 2; ++h) {
    for (const std::size_t v : views[h]) ++counts[h][observations.views[v].tag];
  }
  const auto in_both = [&](int tag) { return std::min(counts[0][tag], counts[1][tag]); };
  if (in_both(solution.held_tag) >= 2) return solution.held_tag;
  std::optional<int> best;
  for (const int tag : solution.part.tags) {
    if (in_both(tag) >= 2 && (!best || in_both(tag) > in_both(*best))) best = tag;
  }
  return best;
}

bool solve_half(const Observations& observations, const PartSolution& solution, int held_tag,
                const CalibrationOptions& options, const std::vector<std::size_t>& views, Half& half) {
  half.part = connected_to(observations, views, held_tag, options.min_views);
  if (half.part.tags.size() < 2) return false;
  half.state = solution.state;
  move_origin_to(half.state, held_tag);
  std::vector<int> free_tags = half.part.tags;
  std::erase(free_tags, held_tag);
  const AdjustmentSummary summary =
      adjust(observations, half.part.views, free_tags, adjustment_options(options), half.state);
  return summary.is_usable && summary.has_converged;
}

/// How the poses follow errors of cameras and prints.
Eigen::MatrixXd by_taken(const Observations& observations, const PartSolution& solution, const Half& half,
                         const PoseInformation& poses) {
  const std::vector<ParameterView> errors = taken_errors(observations, solution, half.part.views, half.state);
  if (errors.empty()) return Eigen::MatrixXd::Zero(poses.size(), 0);
  return poses.eliminate_poses(errors).poses_by_parameter;
}

bool measure_half(const Observations& observations, const PartSolution& solution, int held_tag, Half& half) {
  const std::vector<LinearView> views = corner_views(observations, half.part.views, half.state);
  const auto poses = PoseInformation::of(views, half.part.tags, held_tag);
  if (!poses || views.size() != half.part.views.size()) return false;
  std::vector<TagKey> keys;
  for (const int tag : solution.part.tags) keys.push_back(observations.tags[static_cast<std::size_t>(tag)]);
  half.joint = joint_tag_covariance(*poses, solution.part.tags, keys, solution.scale);
  half.by_taken = spread_rows(*poses, solution.part.tags, by_taken(observations, solution, half, *poses));
  return true;
}

/// Errors that a tag keeps, and those of cameras and prints, are the same in both halves: only what the two
/// make of them differently counts.
Eigen::MatrixXd covariance_of_difference(const Half& first, const Half& second) {
  const Eigen::MatrixXd kept = first.joint.by_errors - second.joint.by_errors;
  const Eigen::MatrixXd taken = first.by_taken - second.by_taken;
  return first.joint.by_noise + second.joint.by_noise + kept * kept.transpose() + taken * taken.transpose();
}

double squared_in(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& difference) {
  // Scaled, since sigmas of near and far tags, and metres and radians, differ.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::VectorXd x = scale.cwiseProduct(difference);
  return x.dot(scaled.ldlt().solve(x)) / static_cast<double>(difference.size());
}

std::string words_of(const CrossValidation& result) {
  const double factor = std::sqrt(result.normalised_error_squared);
  if (!result.is_in_doubt())
    return fmt::format(
        "the two halves of the recording agree: they differ by {:.1f} times what their covariances expect",
        factor);
  return fmt::format(
      "the two halves of the recording disagree by {:.1f} times what their covariances claim: the lens model "
      "is wrong, a tag or what it hangs on moves or bends, or the shutter rolls; trust the map by as much "
      "less",
      factor);
}

/// tags: that both halves have, without the held one.
void compare(const Observations& observations, const PartSolution& solution, const std::vector<int>& tags,
             const Half& first, const Half& second, CrossValidation& result) {
  const Eigen::MatrixXd covariance = covariance_of_difference(first, second);
  const auto num = static_cast<Eigen::Index>(tags.size());
  const auto row_of = [&](Eigen::Index i) {
    const int tag = tags[static_cast<std::size_t>(i)];
    return 6 * static_cast<Eigen::Index>(std::ranges::lower_bound(solution.part.tags, tag) -
                                         solution.part.tags.begin());
  };
  Eigen::MatrixXd of_tags(6 * num, 6 * num);
  Eigen::VectorXd differences(6 * num);
  for (Eigen::Index a = 0; a < num; ++a) {
    const auto t = static_cast<std::size_t>(tags[static_cast<std::size_t>(a)]);
    const Vector6d xi = (first.state.T_map_tag[t].inverse() * second.state.T_map_tag[t]).log();
    const Matrix6d own = covariance.block<6, 6>(row_of(a), row_of(a));
    differences.segment<6>(6 * a) = xi;
    for (Eigen::Index b = 0; b < num; ++b)
      of_tags.block<6, 6>(6 * a, 6 * b) = covariance.block<6, 6>(row_of(a), row_of(b));
    result.tags.push_back({observations.tags[t], xi.head<3>().norm(), xi.tail<3>().norm(),
                           std::sqrt(own.topLeftCorner<3, 3>().trace()),
                           std::sqrt(own.bottomRightCorner<3, 3>().trace()), squared_in(own, xi)});
  }
  result.normalised_error_squared = squared_in(of_tags, differences);
  result.words = words_of(result);
}

}  // namespace

CrossValidation cross_validate(const Observations& observations, const PartSolution& solution,
                               const CalibrationOptions& options) {
  CrossValidation result;
  if (solution.part.tags.size() > static_cast<std::size_t>(options.max_tags_with_joint_covariance)) {
    result.why_not = fmt::format("the map has over {} tags", options.max_tags_with_joint_covariance);
    return result;
  }
  if (solution.covariances.empty()) {
    result.why_not = fmt::format("the map has over {} tags, and no covariances to compare with",
                                 options.max_tags_with_covariance);
    return result;
  }
  const std::size_t num_moments = moments_of(observations, solution.part.views).size();
  if (num_moments < kLeastMomentsToHalve) {
    result.why_not = fmt::format("{} moments are too few to be cut in two ({} are needed)", num_moments,
                                 kLeastMomentsToHalve);
    return result;
  }
  const auto views = split_by_blocks(observations, solution.part.views);
  const auto held_tag = common_tag(observations, solution, views);
  std::array<Half, 2> halves;
  const auto solve = [&](std::size_t h) {
    return solve_half(observations, solution, *held_tag, options, views[h], halves[h]);
  };
  if (!held_tag || !solve(0) || !solve(1)) {
    result.why_not = "half of the moments do not determine a map";
    return result;
  }
  std::vector<int> tags;
  std::ranges::set_intersection(halves[0].part.tags, halves[1].part.tags, std::back_inserter(tags));
  std::erase(tags, *held_tag);
  if (tags.empty() || !measure_half(observations, solution, *held_tag, halves[0]) ||
      !measure_half(observations, solution, *held_tag, halves[1])) {
    result.why_not = "half of the moments do not determine a map";
    return result;
  }
  result.held_tag = observations.tags[static_cast<std::size_t>(*held_tag)];
  result.moments_of_first = static_cast<int>(moments_of(observations, halves[0].part.views).size());
  result.moments_of_second = static_cast<int>(moments_of(observations, halves[1].part.views).size());
  compare(observations, solution, tags, halves[0], halves[1], result);
  return result;
}

}  // namespace apriltrack
