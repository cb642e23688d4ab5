#include "bag_topics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "apriltrack/base/error.h"
#include "picture_message.h"

namespace apriltrack {
namespace {

/// What image_transport hangs behind a topic's name.
std::string without_transport(const std::string& topic) {
  for (const std::string_view ending : {"/compressed", "/compressedDepth"})
    if (topic.ends_with(ending)) return topic.substr(0, topic.size() - ending.size());
  return topic;
}

std::string list_of(const BagReader& bag, const std::vector<std::size_t>& topics) {
  std::vector<std::string> texts;
  for (const std::size_t topic : topics) texts.push_back(description_of(bag.topics()[topic]));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string list_of_all(const BagReader& bag) {
  std::vector<std::size_t> all(bag.topics().size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return list_of(bag, all);
}

/// Video in messages, which needs a decoder of its own.
bool is_video_type(const std::string& type) {
  constexpr std::array<std::string_view, 4> kWords = {"theora", "CompressedVideo", "FFMPEG", "H264"};
  return std::ranges::any_of(kWords,
                             [&](std::string_view word) { return type.find(word) != std::string::npos; });
}

[[noreturn]] void refuse_without_images(const BagReader& bag, const std::string& name) {
  const bool has_video =
      std::ranges::any_of(bag.topics(), [](const BagTopic& topic) { return is_video_type(topic.type); });
  throw invalid_input(
      name,
      fmt::format(
          "has no topic with pictures ({}){}; it has: {}", kPictureTypes,
          has_video ? "; video in messages (theora, h264) is not read: republish it as one of these" : "",
          list_of_all(bag)));
}

std::size_t find_named(const BagReader& bag, const std::string& name, const std::string& wanted) {
  const auto& topics = bag.topics();
  const auto found = std::ranges::find(topics, wanted, &BagTopic::name);
  if (found == topics.end())
    throw invalid_input("--topic",
                        fmt::format("{} has no topic '{}'; it has: {}", name, wanted, list_of_all(bag)));
  const auto with_images = std::ranges::find_if(
      topics, [&](const BagTopic& topic) { return topic.name == wanted && is_image_topic(topic); });
  if (with_images == topics.end())
    throw invalid_input(
        "--topic", fmt::format("'{}' of {} is of type {}; pictures are {}; topics with these: {}", wanted,
                               name, found->type, kPictureTypes, list_of(bag, image_topics(bag))));
  return static_cast<std::size_t>(with_images - topics.begin());
}

}  // namespace

bool is_image_topic(const BagTopic& topic) {
  return is_picture_type(topic.type);
}

std::vector<std::size_t> image_topics(const BagReader& bag) {
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
    if (is_image_topic(bag.topics()[i]) && bag.topics()[i].count > 0) topics.push_back(i);
  std::ranges::sort(topics, {}, [&](std::size_t i) { return bag.topics()[i].name; });
  return topics;
}

std::string description_of(const BagTopic& topic) {
  return fmt::format("{} ({}, {} message{})", topic.name, topic.type, topic.count,
                     topic.count == 1 ? "" : "s");
}

std::size_t choose_image_topic(const BagReader& bag, const std::string& name, const std::string& wanted) {
  if (bag.topics().empty()) {
    const std::string damage = bag.damage();
    throw io_error(
        name, fmt::format("is a bag without a topic or a message{}", damage.empty() ? "" : ": " + damage));
  }
  const std::size_t topic = [&] {
    if (!wanted.empty()) return find_named(bag, name, wanted);
    const std::vector<std::size_t> topics = image_topics(bag);
    if (topics.empty()) refuse_without_images(bag, name);
    if (topics.size() > 1)
      throw invalid_input("--topic", fmt::format("is required: {} has several topics with pictures: {}", name,
                                                 list_of(bag, topics)));
    return topics.front();
  }();
  const BagTopic& chosen = bag.topics()[topic];
  if (!is_read_topic(chosen))
    throw invalid_input(name, fmt::format("topic {}: its messages are encoded as '{}'; read are {}",
                                          chosen.name, chosen.encoding, read_encodings(chosen.type)));
  if (chosen.count == 0) throw io_error(name, fmt::format("topic {} has no messages", chosen.name));
  return topic;
}

std::optional<std::size_t> camera_info_topic(const BagReader& bag, const BagTopic& images) {
  const std::string base = without_transport(images.name);
  const std::string folder = base.substr(0, base.rfind('/') + 1);
  for (const char* name : {"camera_info", "calibration"}) {
    const auto found = std::ranges::find_if(bag.topics(), [&](const BagTopic& topic) {
      return topic.name == folder + name && topic.count > 0 && is_camera_type(topic.type);
    });
    if (found != bag.topics().end()) return static_cast<std::size_t>(found - bag.topics().begin());
  }
  return std::nullopt;
}

bool is_rectified(const BagTopic& images) {
  const std::string base = without_transport(images.name);
  return base.substr(base.rfind('/') + 1).starts_with("image_rect");
}

}  // namespace apriltrack
