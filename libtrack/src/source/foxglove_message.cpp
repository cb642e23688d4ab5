#include "foxglove_message.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
namespace apriltrack {
namespace {

std::int64_t whole_number(const YamlNode& node, std::int64_t most) {
  const double value = node.as_double();
  if (!(value >= 0.0 && value <= static_cast<double>(most) && value == std::floor(value)))
    node.fail(fmt::format("must be a whole number from 0 to {} (is {})", most, node.as_string()));
  return static_cast<std::int64_t>(value);
}

}  // namespace

Timestamp read_foxglove_time(const YamlNode& time) {
  // The nanoseconds since 1970 have 63 bits.
  constexpr std::int64_t kMostSeconds = std::numeric_limits<std::int64_t>::max() / kNsPerSecond - 1;
  return {kNsPerSecond * whole_number(time.at("sec"), kMostSeconds) +
          whole_number(time.at("nsec"), kNsPerSecond - 1)};
}

bool is_foxglove(const BagTopic& topic, std::string_view type) {
  return topic.type == type && topic.encoding == "json";
}

RosPose read_foxglove_pose(std::string_view bytes, const std::string& where) {
  const YamlNode message = YamlNode::read_json_text(std::string(bytes), where);
  const YamlNode pose = message.at("pose");
  const YamlNode p = pose.at("position"), q = pose.at("orientation");
  return {read_foxglove_time(message.at("timestamp")),
          {p.at("x").as_double(), p.at("y").as_double(), p.at("z").as_double()},
          {q.at("w").as_double(), q.at("x").as_double(), q.at("y").as_double(), q.at("z").as_double()}};
}

}  // namespace apriltrack
