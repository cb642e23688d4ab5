#pragma once

namespace CLI {
class App;
}

namespace apriltrack::app {

/// Help of --topic.
inline constexpr const char* kTopicOfCamera =
    "Of a bag: the topic of the pictures whose camera is meant; by default the only one with pictures";

// The verbs of `camera`.
void add_camera_show(CLI::App& camera_command);
void add_camera_convert(CLI::App& camera_command);

}  // namespace apriltrack::app
