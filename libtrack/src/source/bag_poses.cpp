#include "apriltrack/source/bag_poses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "foxglove_message.h"
#include "pose_topics.h"
#include "ros_message.h"

namespace apriltrack {
namespace {

BagPose checked(const RosPose& message, const std::string& where) {
  constexpr double kMostLengthError = 0.05;  // as in files of trajectories
  if (!message.position.allFinite())
    throw invalid_input(where, "position: holds a number that is not finite");
  if (!(std::abs(message.orientation.norm() - 1.0) <= kMostLengthError))
    throw invalid_input(where, fmt::format("orientation: length of the quaternion must be 1 (is {:.4g})",
                                           message.orientation.norm()));
  return {message.stamp, {message.orientation, message.position}};
}

/// Messages that are left out, for they are not as their type says.
struct BadMessages {
  std::size_t count = 0;
  std::optional<Error> first;
};

/// Goes through the messages of the topics; `take` gets each with what errors call it, and what it throws is
/// what is wrong with that one. Throws it where none is good.
template <class Take>
void for_each_message(BagReader& bag, const PoseTopics& topics, const std::string& input, BadMessages& bad,
                      const Take& take) {
  bag.choose(topics.indices);
  std::size_t count = 0;
  const auto leave_out = [&](const Error& error) {
    if (bad.count++ == 0) bad.first = error;
  };
  while (const auto message = bag.next()) {
    if (!message->error.empty()) continue;  // damage() tells
    const BagTopic& topic = bag.topics()[message->topic];
    const std::string where = fmt::format("{} {} message {}", input, topic.name, count++);
    try {
      take(topic, message->bytes, where);
    } catch (const BadMessage& error) {
      leave_out(invalid_input(where, error.what()));
    } catch (const Error& error) {
      leave_out(error);
    }
  }
  if (bad.first && bad.count == count) throw Error(*bad.first);
}

std::vector<BagPose> read_poses(BagReader& bag, const PoseTopics& topics, const std::string& input,
                                BadMessages& bad) {
  std::vector<BagPose> poses;
  for_each_message(
      bag, topics, input, bad, [&](const BagTopic& topic, std::string_view bytes, const std::string& where) {
        poses.push_back(checked(topics.kind == PoseKind::kFoxglove ? read_foxglove_pose(bytes, where)
                                                                   : read_pose_message(topic, bytes),
                                where));
      });
  return poses;
}

/// A path is published again and again as it grows: the last one that is not empty is whole.
std::vector<BagPose> read_last_path(BagReader& bag, const PoseTopics& topics, const std::string& input,
                                    BadMessages& bad) {
  std::vector<BagPose> poses;
  for_each_message(bag, topics, input, bad,
                   [&](const BagTopic& topic, std::string_view bytes, const std::string& where) {
                     const std::vector<RosPose> path = read_path_message(topic, bytes);
                     if (path.empty()) return;
                     poses.clear();
                     for (const RosPose& pose : path) {
                       if (pose.stamp == Timestamp{})
                         throw BadMessage(
                             "its poses carry no times (header.stamp is 0), as those of planned paths: "
                             "such a path is no trajectory");
                       poses.push_back(checked(pose, where));
                     }
                   });
  return poses;
}

/// Poses by "PARENT:CHILD".
using TransformsByPair = std::map<std::string, std::vector<BagPose>>;

bool are_same(const BagPose& a, const BagPose& b) {
  return a.timestamp == b.timestamp && a.pose.translation() == b.pose.translation() &&
         a.pose.rotation().coeffs() == b.pose.rotation().coeffs();
}

TransformsByPair read_transforms(BagReader& bag, const PoseTopics& topics, const std::string& input,
                                 BadMessages& bad) {
  TransformsByPair by_pair;
  for_each_message(bag, topics, input, bad,
                   [&](const BagTopic& topic, std::string_view bytes, const std::string& where) {
                     for (const RosTransform& transform : read_tf_message(topic, bytes)) {
                       auto& poses = by_pair[transform.parent + ":" + transform.child];
                       const BagPose pose = checked(transform.pose, where);
                       if (poses.empty() || !are_same(poses.back(), pose)) poses.push_back(pose);
                     }
                   });
  return by_pair;
}

std::string list_of(const TransformsByPair& by_pair) {
  std::vector<std::string> texts;
  for (const auto& [pair, poses] : by_pair)
    texts.push_back(fmt::format("{} ({} pose{})", pair, poses.size(), poses.size() == 1 ? "" : "s"));
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

std::vector<BagPose> choose_pair(TransformsByPair by_pair, const std::string& wanted,
                                 const std::string& input) {
  if (wanted.empty() && by_pair.size() == 1) return std::move(by_pair.begin()->second);
  if (wanted.empty())
    throw invalid_input(input, fmt::format("has transforms between {} pairs of frames, PARENT:CHILD: {}; "
                                           "--transform PARENT:CHILD names one",
                                           by_pair.size(), list_of(by_pair)));
  const auto found = by_pair.find(wanted);
  if (found == by_pair.end())
    throw invalid_input("--transform",
                        fmt::format("{} has no transforms of '{}', PARENT:CHILD (they are not chained, nor "
                                    "inverted); it has: {}",
                                    input, wanted, list_of(by_pair)));
  return std::move(found->second);
}

std::vector<BagPose> read_chosen(BagReader& bag, const std::string& input, const BagPoseChoice& choice,
                                 BadMessages& bad) {
  const PoseTopics topics = choose_pose_topics(bag, input, choice);
  switch (topics.kind) {
    case PoseKind::kPose:
    case PoseKind::kFoxglove:
      return read_poses(bag, topics, input, bad);
    case PoseKind::kPath:
      return read_last_path(bag, topics, input, bad);
    case PoseKind::kTransforms:
      return choose_pair(read_transforms(bag, topics, input, bad), choice.transform, input);
  }
  return {};
}

}  // namespace

std::vector<BagPose> read_bag_poses(const std::string& input, const BagPoseChoice& choice,
                                    const LogSink& log) {
  const auto bag = open_bag(input, log);
  BadMessages bad;
  std::vector<BagPose> poses = read_chosen(*bag, input, choice, bad);
  if (bad.first)
    log(LogLevel::kWarning, fmt::format("{} message{} left out; the first: {}", bad.count,
                                        bad.count == 1 ? " is" : "s are", bad.first->what()));
  if (const std::string damage = bag->damage(); !damage.empty())
    log(LogLevel::kWarning, fmt::format("{}: {}", input, damage));
  return poses;
}

}  // namespace apriltrack
