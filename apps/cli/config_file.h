#pragma once

#include <filesystem>

namespace CLI {
class App;
}

namespace apriltrack::app {

/// Fills in the options of `command` that the command line left out from a YAML file whose keys are their
/// long names (`tag-size: 0.16`, `family: [tag36h11, tag25h9]`). The command line wins.
/// Throws Error(kIo) when the file cannot be read; Error(kInvalidInput) with file and line for an unknown key
/// (the message lists those there are) or a value that the option does not take.
void apply_config_file(CLI::App& command, const std::filesystem::path& path);

}  // namespace apriltrack::app
