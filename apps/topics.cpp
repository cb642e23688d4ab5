#include "topics.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/ros_topics.h"
#include "apriltrack/source/bag_input.h"
#include "choice_option.h"
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

bool has_pictures(const std::vector<BagImageTopic>& topics, const std::string& name) {
  return !name.empty() && std::ranges::count(topics, name, &BagImageTopic::name) > 0;
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
  for (const Camera& camera : rig->cameras) {
    const auto rostopic = rostopics.find(camera.name);
    if (rostopic != rostopics.end() && has_pictures(topics, rostopic->second))
      recordings.push_back({camera.name, bag.input, true, rostopic->second});
  }
  for (const Recording& recording : recordings) tell_of_rostopic(recording, console);
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
  if (topics.size() < 2 || !has_pictures(topics, rostopic->second)) return;
  bag.topic = rostopic->second;
  tell_of_rostopic(bag, console);
}

/// What image_transport hangs behind a topic's name is the same pictures.
std::string without_transport(const std::string& topic) {
  constexpr std::string_view kCompressed = "/compressed";
  return topic.ends_with(kCompressed) ? topic.substr(0, topic.size() - kCompressed.size()) : topic;
}

/// A topic that the camera file gives to another camera, or beside which the camera's own is in the bag.
/// Topics that were renamed are neither.
void warn_of_other_topic(const Recording& recording, const TopicOfCamera& rostopics, const Console& console) {
  const auto own = rostopics.find(recording.camera);
  const std::string read = without_transport(recording.topic);
  if (recording.topic.empty() || own == rostopics.end() || without_transport(own->second) == read) return;
  const auto other = std::ranges::find_if(
      rostopics, [&](const auto& entry) { return without_transport(entry.second) == read; });
  if (other == rostopics.end() && !has_pictures(bag_image_topics(recording.input), own->second)) return;
  console.warning(fmt::format(
      "{} is read for {}, but rostopic of {} in the camera file is {}{}: is that the camera that filmed it?",
      recording.topic, recording.camera, recording.camera, own->second,
      other == rostopics.end() ? "" : fmt::format(", and {} is that of {}", recording.topic, other->first)));
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

std::string topic_without_camera(const std::vector<std::string>& topics) {
  const std::vector<TopicChoice> choices = parse_topics(topics);
  for (const TopicChoice& choice : choices)
    if (choice.camera.empty()) return choice.topic;
  return choices.size() == 1 ? choices.front().topic : "";
}

}  // namespace apriltrack::app
