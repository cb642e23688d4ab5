#include "pose_topics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "apriltrack/base/error.h"
#include "bag_topics.h"
#include "foxglove_message.h"
#include "ros_message.h"

namespace apriltrack {
namespace {

std::optional<PoseKind> kind_of(const BagTopic& topic) {
  if (is_foxglove(topic, kFoxglovePose)) return PoseKind::kFoxglove;
  if (!is_read_encoding(topic.encoding)) return std::nullopt;
  if (is_ros_pose_type(topic.type)) return PoseKind::kPose;
  if (is_ros_path_type(topic.type)) return PoseKind::kPath;
  if (is_tf_type(topic.type)) return PoseKind::kTransforms;
  return std::nullopt;
}

std::string list_of(const BagReader& bag, const std::set<std::size_t>& topics) {
  std::vector<std::string> texts;
  for (const std::size_t i : topics) texts.push_back(description_of(bag.topics()[i]));
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

std::set<std::size_t> all_topics(const BagReader& bag) {
  std::set<std::size_t> all;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) all.insert(i);
  return all;
}

/// Those that the choice leaves.
std::map<PoseKind, std::set<std::size_t>> topics_by_kind(const BagReader& bag, const BagPoseChoice& choice) {
  std::map<PoseKind, std::set<std::size_t>> by_kind;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    const auto kind = kind_of(bag.topics()[i]);
    if (!kind || (!choice.topic.empty() && bag.topics()[i].name != choice.topic)) continue;
    if (!choice.transform.empty() && kind != PoseKind::kTransforms) continue;
    by_kind[*kind].insert(i);
  }
  return by_kind;
}

[[noreturn]] void refuse_without_poses(const BagReader& bag, const std::string& name,
                                       const BagPoseChoice& choice) {
  const std::string types = choice.transform.empty()
                                ? fmt::format(
                                      "poses (geometry_msgs/PoseStamped, PoseWithCovarianceStamped, "
                                      "TransformStamped, nav_msgs/Odometry, {}, nav_msgs/Path, "
                                      "tf2_msgs/TFMessage)",
                                      kFoxglovePose)
                                : "transforms (tf2_msgs/TFMessage, tf/tfMessage)";
  throw invalid_input(
      choice.topic.empty() ? name : "--topic",
      fmt::format(
          "{} with {}; it has: {}",
          choice.topic.empty() ? "has no topic" : fmt::format("{} has no topic '{}'", name, choice.topic),
          types, list_of(bag, all_topics(bag))));
}

[[noreturn]] void refuse_several(const BagReader& bag, const std::string& name,
                                 const std::set<std::size_t>& topics) {
  throw invalid_input(name, fmt::format("has several topics with poses: {}; --topic names one of them",
                                        list_of(bag, topics)));
}

}  // namespace

PoseTopics choose_pose_topics(const BagReader& bag, const std::string& name, const BagPoseChoice& choice) {
  std::map<PoseKind, std::set<std::size_t>> by_kind = topics_by_kind(bag, choice);
  // What is meant to be a trajectory goes before what is there besides.
  const auto& foxglove = by_kind[PoseKind::kFoxglove];
  std::set<std::size_t> poses = by_kind[PoseKind::kPose];
  if (foxglove.size() == 1) return {PoseKind::kFoxglove, foxglove};
  if (foxglove.empty() && poses.size() == 1) return {PoseKind::kPose, poses};
  poses.insert(foxglove.begin(), foxglove.end());
  if (!poses.empty()) refuse_several(bag, name, poses);
  const auto& paths = by_kind[PoseKind::kPath];
  if (paths.size() > 1) refuse_several(bag, name, paths);
  if (!paths.empty()) return {PoseKind::kPath, paths};
  const auto& transforms = by_kind[PoseKind::kTransforms];
  if (transforms.empty()) refuse_without_poses(bag, name, choice);
  return {PoseKind::kTransforms, transforms};
}

}  // namespace apriltrack
