#include "apriltrack/source/bag_poses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "bag_topics.h"
#include "foxglove_message.h"
#include "ros_message.h"

namespace apriltrack {
namespace {

bool is_foxglove_pose(const BagTopic& topic) {
  return is_foxglove(topic, kFoxglovePose);
}

bool is_pose_topic(const BagTopic& topic) {
  return is_foxglove_pose(topic) || (is_read_encoding(topic.encoding) && is_ros_pose_type(topic.type));
}

std::string list_of_topics(const std::vector<BagTopic>& topics) {
  std::vector<std::string> texts;
  for (const BagTopic& topic : topics) texts.push_back(told(topic));
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

std::size_t choose_pose_topic(const BagReader& bag, const std::string& name, const std::string& wanted) {
  std::vector<std::size_t> poses, by_foxglove;
  std::vector<BagTopic> known;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    const BagTopic& topic = bag.topics()[i];
    if (!is_pose_topic(topic) || (!wanted.empty() && topic.name != wanted)) continue;
    poses.push_back(i);
    known.push_back(topic);
    if (is_foxglove_pose(topic)) by_foxglove.push_back(i);
  }
  if (poses.size() == 1) return poses.front();
  if (by_foxglove.size() == 1) return by_foxglove.front();
  if (poses.empty())
    throw invalid_input(
        wanted.empty() ? name : "--topic",
        fmt::format("{} with poses (geometry_msgs/PoseStamped, PoseWithCovarianceStamped, "
                    "TransformStamped, nav_msgs/Odometry, {}); it has: {}",
                    wanted.empty() ? "has no topic" : fmt::format("{} has no topic '{}'", name, wanted),
                    kFoxglovePose, list_of_topics(bag.topics())));
  throw invalid_input(name,
                      fmt::format("has several topics with poses: {}; `trajectory convert --topic` takes "
                                  "one of them out",
                                  list_of_topics(known)));
}

BagPose checked(const RosPose& message, const std::string& where) {
  constexpr double kMostLengthError = 0.05;  // as in files of trajectories
  if (!message.position.allFinite())
    throw invalid_input(where, "position: holds a number that is not finite");
  if (!(std::abs(message.orientation.norm() - 1.0) <= kMostLengthError))
    throw invalid_input(where, fmt::format("orientation: length of the quaternion must be 1 (is {:.4g})",
                                           message.orientation.norm()));
  return {message.stamp, {message.orientation, message.position}};
}

}  // namespace

std::vector<BagPose> read_bag_poses(const std::string& input, const std::string& wanted, const LogSink& log) {
  const auto bag = open_bag(input, log);
  const std::size_t index = choose_pose_topic(*bag, input, wanted);
  const BagTopic topic = bag->topics()[index];
  bag->choose({index});
  std::vector<BagPose> poses;
  while (const auto message = bag->next()) {
    if (!message->error.empty()) continue;  // damage() tells
    const std::string where = fmt::format("{} {} message {}", input, topic.name, poses.size());
    try {
      poses.push_back(checked(is_foxglove_pose(topic) ? read_foxglove_pose(message->bytes, where)
                                                      : read_pose_message(topic, message->bytes),
                              where));
    } catch (const BadMessage& error) {
      throw invalid_input(where, error.what());
    }
  }
  if (const std::string damage = bag->damage(); !damage.empty())
    log(LogLevel::kWarning, fmt::format("{}: {}", input, damage));
  return poses;
}

}  // namespace apriltrack
