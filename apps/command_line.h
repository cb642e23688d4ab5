#pragma once

#include <string>

namespace CLI {
class App;
}

namespace apriltrack::app {

/// What the user typed for this command, to be pasted into a shell again: "apriltrack track room --mode ego".
/// Options that were left out stay so.
std::string command_line_of(const CLI::App& command);

}  // namespace apriltrack::app
