#include "pose_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"
#include "apriltrack/source/bag_input.h"

namespace apriltrack::app {
namespace {

constexpr const char* kTopicHelp = "Of a bag: the topic with poses, where there are several";
constexpr const char* kTransformHelp =
    "Of a bag's transforms (tf): PARENT:CHILD, the frames that they lead between, where there are several "
    "pairs; poses are T_parent_child";
constexpr const char* kRolesHelp = "; of one trajectory alone: truth=NAME or estimate=NAME";

/// A word of `--topic` or `--transform`; role: empty: of both.
struct RoleWord {
  std::string role;
  std::string word;
};

/// Names of topics and frames have no =.
RoleWord parsed(const std::string& option, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) return {"", text};
  RoleWord parsed = {text.substr(0, equals), text.substr(equals + 1)};
  if ((parsed.role != "truth" && parsed.role != "estimate") || parsed.word.empty())
    throw invalid_input(option, fmt::format("must be NAME, truth=NAME or estimate=NAME (is '{}')", text));
  return parsed;
}

/// Empty where there is none.
std::string word_for(const std::string& role, const std::string& option,
                     const std::vector<std::string>& texts) {
  std::string found;
  for (const std::string& text : texts) {
    const RoleWord one = parsed(option, text);
    if (one.role != role) continue;
    if (!found.empty())
      throw invalid_input(option,
                          fmt::format("is given twice for {}", role.empty() ? "both trajectories" : role));
    found = one.word;
  }
  return found;
}

}  // namespace

void add_pose_choice_options(CLI::App& command, BagPoseChoice& choice) {
  command.add_option("--topic", choice.topic, kTopicHelp);
  command.add_option("--transform", choice.transform, kTransformHelp);
}

void add_pose_choice_options(CLI::App& command, PoseChoices& choices) {
  command.add_option("--topic", choices.topics, std::string(kTopicHelp) + kRolesHelp)
      ->allow_extra_args(false);
  command.add_option("--transform", choices.transforms, std::string(kTransformHelp) + kRolesHelp)
      ->allow_extra_args(false);
}

BagPoseChoice choice_for(const std::string& role, const std::string& path, const PoseChoices& choices) {
  const auto chosen = [&](const std::string& option, const std::vector<std::string>& texts) {
    const std::string of_both = word_for("", option, texts), own = word_for(role, option, texts);
    return own.empty() && is_bag_input(path) ? of_both : own;
  };
  return {chosen("--topic", choices.topics), chosen("--transform", choices.transforms)};
}

void check_pose_choices(const PoseChoices& choices, const std::vector<std::string>& paths) {
  if (std::ranges::any_of(paths, [](const std::string& path) { return is_bag_input(path); })) return;
  for (const auto& [option, texts] :
       {std::pair{"--topic", &choices.topics}, std::pair{"--transform", &choices.transforms}})
    if (!texts->empty())
      throw invalid_input(option, "is of a bag, and neither --truth nor --estimate is one: leave it out");
}

}  // namespace apriltrack::app
