#pragma once

namespace CLI {
class App;
}

namespace apriltrack::app {

// The verbs of `camera`.
void add_camera_show(CLI::App& camera_command);
void add_camera_convert(CLI::App& camera_command);

}  // namespace apriltrack::app
