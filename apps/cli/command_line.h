#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace apriltrack::app {

/// One line of which a POSIX shell makes these words: quoted where it would make others, such as a glob's.
std::string shell_line(const std::vector<std::string>& words);

/// What the user typed for this command, to be pasted into a shell again: "apriltrack track room --mode ego".
/// Options that were left out stay so.
std::string command_line_of(const CLI::App& command);

}  // namespace apriltrack::app
