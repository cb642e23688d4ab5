#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/source/frame_source.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

/// Which frames of an INPUT are used, and how they are read: the same words for every command that has an
/// INPUT.
struct FrameOptions {
  SourceOptions source;             ///< rate_hz, bits, skip, step, max_frames and stamp_is.
  std::vector<std::string> topics;  ///< As --topic has them.
};

/// Adds --rate, --bits, --topic, --stamp-is, --skip, --step and --max-frames; `options` must outlive the
/// command.
void add_frame_options(CLI::App& command, FrameOptions& options);

/// Their names, for refuse_beside_detections().
inline constexpr std::initializer_list<const char*> kFrameOptionNames = {
    "--rate", "--bits", "--topic", "--stamp-is", "--skip", "--step", "--max-frames"};

/// Adds --config: a YAML file of further options. It is applied before the parser asks for what is required.
void add_config_option(CLI::App& command, std::string& config);

/// What --stamp-is needs to know of the camera.
void set_shutter(SourceOptions& options, const Camera& camera);

}  // namespace apriltrack::app
