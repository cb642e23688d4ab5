#include "value_names.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace apriltrack::app {
namespace {

struct ValueName {
  std::string_view option;
  std::string_view value;
};

// One option means one thing in all commands.
constexpr ValueName kValueNames[] = {
    {"--bits", "BITS"},
    {"--blackout", "FRAME:COUNT"},
    {"--bundle", "NAME"},
    {"--camera", "FILE"},
    {"--camera-name", "NAME"},
    {"--config", "FILE"},
    {"--conflict-deg", "DEGREES"},
    {"--conflict-mm", "MM"},
    {"--constraints", "FILE"},
    {"--decimate", "FACTOR"},
    {"--detections", "FILE"},
    {"--edge-offset-sigma", "PX"},
    {"--estimate", "FILE"},
    {"--exposure", "SECONDS"},
    {"--family", "FAMILY"},
    {"--field-length", "METRES"},
    {"--field-width", "METRES"},
    {"--flicker", "DEPTH"},
    {"--frames", "N"},
    {"--frames-csv", "FILE"},
    {"--gain", "FACTOR"},
    {"--held-tag", "TAG"},
    {"--joint-covariance", "FILE"},
    {"--light", "FACTOR"},
    {"--man-folder", "FOLDER"},
    {"--map", "FILE"},
    {"--map-frame", "NAME"},
    {"--max-frames", "N"},
    {"--max-hamming", "BITS"},
    {"--min-margin", "MARGIN"},
    {"--min-views", "N"},
    {"--noise", "FACTOR"},
    {"--occlude", "SHARE"},
    {"--output", "FILE"},
    {"--output-format", "FORMAT"},
    {"--particles", "N"},
    {"--parts", "FOLDER"},
    {"--rate", "HZ"},
    {"--report", "FILE"},
    {"--resolution", "WIDTHxHEIGHT"},
    {"--response", "RESPONSE"},
    {"--scene", "SCENE"},
    {"--seed", "N"},
    {"--skip", "N"},
    {"--speed", "FACTOR"},
    {"--step", "STEP"},
    {"--tag-size", "METRES"},
    {"--tag-sizes", "FILE"},
    {"--tags-csv", "FILE"},
    {"--take", "N"},
    {"--threads", "N"},
    {"--times", "FILE"},
    {"--to", "FORMAT"},
    {"--topic", "NAME"},
    {"--trajectory", "FILE"},
    {"--transform", "PARENT:CHILD"},
    {"--truth", "INPUT"},
    {"--video", "FILE"},
};

// Commands whose --output is a folder of files.
constexpr std::string_view kWritesFolder[] = {"simulate", "demo", "print"};

std::string_view value_of(const CLI::App& command, const std::string& option) {
  if (option == "--output" && std::ranges::find(kWritesFolder, command.get_name()) != std::end(kWritesFolder))
    return "FOLDER";
  const auto* found = std::ranges::find(kValueNames, option, &ValueName::option);
  if (found == std::end(kValueNames))
    throw std::logic_error("value_names.cpp does not name the value of " + option + " of " +
                           command.get_name());
  return found->value;
}

bool is_choice(const CLI::Option& option) {
  return option.get_type_name().find('{') != std::string::npos;
}

std::string_view value_of_positional(const std::string& name) {
  if (name == "INPUT") return "INPUT";
  return name == "COMMAND" ? "NAME" : "FILE";
}

}  // namespace

void name_values(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    const bool is_flag = option->get_expected_max() == 0;
    if (is_flag || is_choice(*option)) continue;
    option->type_name(std::string(option->get_positional()
                                      ? value_of_positional(option->get_name(true))
                                      : value_of(command, "--" + option->get_lnames().front())));
  }
  for (CLI::App* own : command.get_subcommands([](const CLI::App*) { return true; })) name_values(*own);
}

ValueKind kind_of_value(const std::string& name) {
  if (name == "FILE") return ValueKind::kFile;
  if (name == "FOLDER") return ValueKind::kFolder;
  if (name == "INPUT") return ValueKind::kInput;
  return ValueKind::kText;
}

}  // namespace apriltrack::app
