#include "apriltrack/eval/compare_maps.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/alignment.h"
#include "apriltrack/eval/evaluate_trajectory.h"
#include "apriltrack/eval/statistics.h"
#include "held_tag.h"

namespace apriltrack {
namespace {

struct CommonTag {
  const MapTag* truth = nullptr;
  const MapTag* estimate = nullptr;
};

std::vector<TagKey> keys_missing_in(const TagMap& map, const TagMap& other) {
  std::vector<TagKey> keys;
  for (const MapTag& tag : map.tags) {
    if (!other.find(tag.key)) keys.push_back(tag.key);
  }
  std::ranges::sort(keys);
  return keys;
}

std::vector<CommonTag> common_tags(const TagMap& truth, const TagMap& estimate) {
  std::vector<CommonTag> common;
  for (const MapTag& tag : truth.tags) {
    if (const MapTag* found = estimate.find(tag.key)) common.push_back({&tag, found});
  }
  std::ranges::sort(common, {}, [](const CommonTag& tag) { return tag.truth->key; });
  return common;
}

TagDifference difference_after(const Pose& T_truth_estimate, const CommonTag& tag) {
  const Pose aligned = T_truth_estimate * tag.estimate->T_map_tag;
  TagDifference difference;
  difference.key = tag.truth->key;
  difference.offset_m = aligned.translation() - tag.truth->T_map_tag.translation();
  difference.position_m = difference.offset_m.norm();
  difference.rotation_rad = rotation_angle_rad(aligned.rotation(), tag.truth->T_map_tag.rotation());
  difference.size_difference_m = tag.estimate->size_m - tag.truth->size_m;
  return difference;
}

/// Covariances are relative to the held tag, so that the pose relative to it is judged and no alignment is
/// needed.
std::optional<double> normalised_error(const CommonTag& tag, const CommonTag& held) {
  if (tag.estimate == held.estimate || !tag.estimate->covariance) return std::nullopt;
  const Pose truth = held.truth->T_map_tag.inverse() * tag.truth->T_map_tag;
  const Pose estimate = held.estimate->T_map_tag.inverse() * tag.estimate->T_map_tag;
  const Vector6d xi = pose_error(truth, estimate).xi_estimate_truth;
  const double value = xi.dot(tag.estimate->covariance->partialPivLu().solve(xi)) / 6.0;
  if (!std::isfinite(value))
    throw invalid_input("tag " + to_string(tag.truth->key),
                        "covariance: has no inverse, and is not all zero either");
  return value;
}

Distribution distribution(const std::vector<double>& values) {
  return {root_mean_square(values), mean(values), median(values), *std::ranges::max_element(values)};
}

template <class Value>
std::vector<double> gather(const std::vector<TagDifference>& tags, const Value& value) {
  std::vector<double> values;
  for (const TagDifference& tag : tags) values.push_back(value(tag));
  return values;
}

double spread(const std::vector<Pose>& poses) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Pose& pose : poses) centre += pose.translation() / static_cast<double>(poses.size());
  double sum = 0.0;
  for (const Pose& pose : poses) sum += (pose.translation() - centre).squaredNorm();
  return std::sqrt(sum);
}

std::optional<double> scale_between(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  const double truth_spread = spread(truth);
  if (truth.size() < 2 || truth_spread == 0.0) return std::nullopt;
  return spread(estimate) / truth_spread;
}

void judge_covariances(const std::vector<CommonTag>& common, MapComparison& comparison) {
  const CommonTag* held =
      find_held(common, [](const CommonTag& tag) -> const MapTag& { return *tag.estimate; });
  if (!held) return;
  comparison.held_tag = held->truth->key;
  std::vector<double> values;
  for (std::size_t i = 0; i < common.size(); ++i) {
    comparison.tags[i].nees_over_6 = normalised_error(common[i], *held);
    if (comparison.tags[i].nees_over_6) values.push_back(*comparison.tags[i].nees_over_6);
  }
  if (!values.empty()) comparison.nees_over_6 = distribution(values);
}

}  // namespace

MapComparison compare_maps(const TagMap& truth, const TagMap& estimate) {
  check_tag_map(truth, "the first map");
  check_tag_map(estimate, "the second map");
  const std::vector<CommonTag> common = common_tags(truth, estimate);
  if (common.empty()) {
    throw no_result("map",
                    fmt::format("the maps share no tag (families and ids must be equal): {} tags against {}",
                                truth.tags.size(), estimate.tags.size()));
  }
  std::vector<Pose> truth_poses;
  std::vector<Pose> estimate_poses;
  for (const CommonTag& tag : common) {
    truth_poses.push_back(tag.truth->T_map_tag);
    estimate_poses.push_back(tag.estimate->T_map_tag);
  }
  const auto T_truth_estimate = align_rigidly(truth_poses, estimate_poses, kMapOrientationWeight);
  if (!T_truth_estimate) throw no_result("map", "the common tags do not settle a rotation between the maps");

  MapComparison comparison;
  comparison.T_truth_estimate = *T_truth_estimate;
  comparison.missing = keys_missing_in(truth, estimate);
  comparison.extra = keys_missing_in(estimate, truth);
  for (const CommonTag& tag : common) comparison.tags.push_back(difference_after(*T_truth_estimate, tag));
  const auto positions_m = gather(comparison.tags, [](const TagDifference& tag) { return tag.position_m; });
  comparison.position_m = distribution(positions_m);
  comparison.rotation_rad =
      distribution(gather(comparison.tags, [](const TagDifference& tag) { return tag.rotation_rad; }));
  comparison.worst = static_cast<std::size_t>(std::ranges::max_element(positions_m) - positions_m.begin());
  comparison.scale = scale_between(truth_poses, estimate_poses);
  judge_covariances(common, comparison);
  return comparison;
}

}  // namespace apriltrack
