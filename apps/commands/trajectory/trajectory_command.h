#pragma once

namespace CLI {
class App;
}

namespace apriltrack::app {

// The verbs of `trajectory`.
void add_trajectory_convert(CLI::App& trajectory_command);

}  // namespace apriltrack::app
