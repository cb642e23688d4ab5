#include "topics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/ros_topics.h"
#include "apriltrack/source/bag_input.h"
#include "cli/choice_option.h"
#include "inputs.h"

namespace apriltrack::app {
namespace {

/// A --topic: of one camera, or of all where that is empty.
struct TopicChoice {
  std::string camera;
  std::string topic;
};

/// Names of topics have no =.
std::vector<TopicChoice> parse_topics(const std::vector<std::string>& texts) {
  std::vector<TopicChoice> choices;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    TopicChoice choice;
    if (equals != std::string::npos) choice.camera = text.substr(0, equals);
    choice.topic = equals == std::string::npos ? text : text.substr(equals + 1);
    if (choice.topic.empty() || equals == 0)
      throw invalid_input("--topic", fmt::format("must be NAME or CAMERA=NAME (is '{}')", text));
    const bool is_there_already =
        std::ranges::any_of(choices, [&](const TopicChoice& other) { return other.camera == choice.camera; });
    if (is_there_already)
      throw invalid_input("--topic", fmt::format("is given twice for {}",
                                                 choice.camera.empty() ? "all cameras" : choice.camera));
    choices.push_back(std::move(choice));
  }
  return choices;
}

const TopicChoice* choice_for(const std::string& camera, const std::vector<TopicChoice>& choices) {
  for (const std::string& wanted : {camera, std::string()}) {
    const auto found = std::ranges::find(choices, wanted, &TopicChoice::camera);
    if (found != choices.end()) return &*found;
  }
  return nullptr;
}

/// What image_transport hangs behind a topic's name is the same pictures.
std::string without_transport(const std::string& topic) {
  constexpr std::string_view kCompressed = "/compressed";
  return topic.ends_with(kCompressed) ? topic.substr(0, topic.size() - kCompressed.size()) : topic;
}

/// The topic with a camera's pictures, by its rostopic: that itself, or else as image_transport packs it.
/// Empty where there is none.
std::string topic_of_rostopic(const std::vector<BagImageTopic>& topics, const std::string& rostopic) {
  if (rostopic.empty()) return "";
  if (std::ranges::count(topics, rostopic, &BagImageTopic::name) > 0) return rostopic;
  const auto packed = std::ranges::find_if(topics, [&](const BagImageTopic& topic) {
    return without_transport(topic.name) == without_transport(rostopic);
  });
  return packed == topics.end() ? "" : packed->name;
}

void tell_of_rostopic(const Recording& recording, const Console& console) {
  console.info(fmt::format("{}: {} is read for {}, by rostopic of the camera file (--topic names another)",
                           recording.input, recording.topic, recording.camera));
}

using TopicOfCamera = std::map<std::string, std::string>;

/// As the camera file has them; a bag tells its camera itself.
TopicOfCamera rostopics_of(const std::filesystem::path& camera_file) {
  if (camera_file.empty() || is_bag_input(camera_file.string())) return {};
  return ros_topics(camera_file);
}

/// One recording of a bag for each of several cameras that are named, or known by their topics.
std::vector<Recording> of_several_cameras(const Recording& bag, const std::vector<TopicChoice>& choices,
                                          const CameraRig* rig, const TopicOfCamera& rostopics,
                                          const Console& console) {
  std::vector<Recording> recordings;
  for (const TopicChoice& choice : choices) {
    if (choice.camera.empty()) continue;
    const std::string camera = rig ? camera_named(*rig, choice.camera, "--topic").name : choice.camera;
    recordings.push_back({camera, bag.input, true, choice.topic});
  }
  if (!choices.empty() || !rig || rig->cameras.size() < 2) return recordings;
  const std::vector<BagImageTopic> topics = bag_image_topics(bag.input);
  std::vector<std::string> missing;
  for (const Camera& camera : rig->cameras) {
    const auto rostopic = rostopics.find(camera.name);
    if (rostopic == rostopics.end()) continue;
    const std::string topic = topic_of_rostopic(topics, rostopic->second);
    if (topic.empty())
      missing.push_back(fmt::format("{} ({})", camera.name, rostopic->second));
    else
      recordings.push_back({camera.name, bag.input, true, topic});
  }
  for (const Recording& recording : recordings) tell_of_rostopic(recording, console);
  if (!recordings.empty() && !missing.empty())
    console.warning(
        fmt::format("{}: has no pictures of camera {}, by rostopic of the camera file; --topic "
                    "CAMERA=NAME names another topic",
                    bag.input, fmt::join(missing, ", ")));
  return recordings;
}

/// The topic of a bag of one camera; empty where the bag itself must tell.
void give_topic(Recording& bag, const std::vector<TopicChoice>& choices, const TopicOfCamera& rostopics,
                const Console& console) {
  if (const TopicChoice* const choice = choice_for(bag.camera, choices)) {
    bag.topic = choice->topic;
    return;
  }
  const auto rostopic = rostopics.find(bag.camera);
  if (rostopic == rostopics.end()) return;
  const std::vector<BagImageTopic> topics = bag_image_topics(bag.input);
  const std::string topic = topic_of_rostopic(topics, rostopic->second);
  if (topics.size() < 2 || topic.empty()) return;
  bag.topic = topic;
  tell_of_rostopic(bag, console);
}

/// The topic that is read: as chosen, or the only one there is; else empty.
std::string read_topic(const std::string& chosen, const std::vector<BagImageTopic>& topics) {
  if (!chosen.empty()) return chosen;
  return topics.size() == 1 ? topics.front().name : "";
}

/// The camera that the camera file gives a topic to; empty where that is none, or several.
std::string camera_of_rostopic(const TopicOfCamera& rostopics, const std::string& topic) {
  std::string camera;
  for (const auto& [name, rostopic] : rostopics) {
    if (without_transport(rostopic) != without_transport(topic)) continue;
    if (!camera.empty()) return "";
    camera = name;
  }
  return camera;
}

/// A topic that the camera file gives to another camera, or beside which the camera's own is in the bag.
/// Topics that were renamed are neither.
void warn_of_other_topic(const Recording& recording, const TopicOfCamera& rostopics, const Console& console) {
  const auto own = rostopics.find(recording.camera);
  if (own == rostopics.end()) return;
  const std::vector<BagImageTopic> topics = bag_image_topics(recording.input);
  const std::string read = read_topic(recording.topic, topics);
  if (read.empty() || without_transport(own->second) == without_transport(read)) return;
  const std::string other = camera_of_rostopic(rostopics, read);
  if (other.empty() && topic_of_rostopic(topics, own->second).empty()) return;
  console.warning(fmt::format(
      "{} is read for {}, but rostopic of {} in the camera file is {}{}: is that the camera that filmed it?",
      read, recording.camera, recording.camera, own->second,
      other.empty() ? "" : fmt::format(", and {} is that of {}", read, other)));
}

void check_all_used(const std::vector<Recording>& recordings, const std::vector<TopicChoice>& choices) {
  for (const TopicChoice& choice : choices) {
    const bool is_used =
        std::ranges::any_of(recordings, [&](const Recording& one) { return one.topic == choice.topic; });
    if (is_used) continue;
    const bool has_bag =
        std::ranges::any_of(recordings, [](const Recording& one) { return is_bag_input(one.input); });
    if (!has_bag) throw invalid_input("--topic", "is of a bag, and no INPUT is one: leave it out");
    throw invalid_input("--topic", fmt::format("'{}' is for {}, which no INPUT is of", choice.topic,
                                               choice.camera.empty() ? "a bag" : "camera " + choice.camera));
  }
}

}  // namespace

void add_bag_options(CLI::App& command, std::vector<std::string>& topics, StampIs& stamp_is) {
  command
      .add_option(
          "--topic", topics,
          "Of a bag with several topics of pictures: which one; of several cameras: cam0=NAME, once for "
          "each. By default the only one, or rostopic of the camera file")
      ->allow_extra_args(false);
  add_choice<StampIs>(
      command, "--stamp-is", stamp_is,
      {{"start", StampIs::kStart}, {"middle", StampIs::kMiddle}, {"end", StampIs::kEnd}},
      "Which moment of the exposure the recorded times are; start and end are moved to the middle by half of "
      "exposure_time of the camera file");
}

std::vector<Recording> with_topics(std::vector<Recording> recordings, const std::vector<std::string>& topics,
                                   const CameraRig* rig, const std::filesystem::path& camera_file,
                                   const Console& console) {
  const std::vector<TopicChoice> choices = parse_topics(topics);
  const TopicOfCamera rostopics = rostopics_of(camera_file);
  std::vector<Recording> all;
  for (Recording& recording : recordings) {
    if (!is_bag_input(recording.input)) {
      all.push_back(std::move(recording));
      continue;
    }
    if (!recording.is_named) {
      const std::vector<Recording> several = of_several_cameras(recording, choices, rig, rostopics, console);
      all.insert(all.end(), several.begin(), several.end());
      if (!several.empty()) continue;
    }
    give_topic(recording, choices, rostopics, console);
    all.push_back(std::move(recording));
  }
  check_all_used(all, choices);
  for (const Recording& recording : all)
    if (is_bag_input(recording.input)) warn_of_other_topic(recording, rostopics, console);
  return all;
}

std::string topic_of(const std::string& input, const std::vector<std::string>& topics,
                     const std::string& camera, const std::filesystem::path& camera_file,
                     const Console& console) {
  return with_topics({{camera, input, true, ""}}, topics, nullptr, camera_file, console).front().topic;
}

std::string camera_name_of(const std::string& input, const std::vector<std::string>& topics,
                           const std::string& camera_name, const std::filesystem::path& camera_file,
                           const Console& console) {
  if (!camera_name.empty() || !is_bag_input(input)) return camera_name;
  const std::vector<TopicChoice> choices = parse_topics(topics);
  if (choices.size() == 1 && !choices.front().camera.empty()) return choices.front().camera;
  const TopicOfCamera rostopics = rostopics_of(camera_file);
  if (rostopics.empty()) return "";
  const std::string topic = read_topic(topic_without_camera(topics), bag_image_topics(input));
  const std::string camera = topic.empty() ? "" : camera_of_rostopic(rostopics, topic);
  if (!camera.empty() && rostopics.size() > 1)
    console.info(
        fmt::format("{}: {} is of camera {}, by rostopic of the camera file (--camera-name names "
                    "another)",
                    input, topic, camera));
  return camera;
}

std::string topic_without_camera(const std::vector<std::string>& topics) {
  const std::vector<TopicChoice> choices = parse_topics(topics);
  for (const TopicChoice& choice : choices)
    if (choice.camera.empty()) return choice.topic;
  return choices.size() == 1 ? choices.front().topic : "";
}

}  // namespace apriltrack::app
