#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apriltrack/eval/trajectory_formats.h"
#include "cli/console.h"
#include "files/frame_options.h"
#include "files/map_input.h"
#include "track_methods.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

/// What a user may tell `track`. Empty names: not given.
struct TrackArguments {
  std::string input;
  std::string detections;
  std::string camera;
  std::string camera_name;
  std::string map;
  MapInputOptions map_input;
  std::string mode = "ego";
  std::string output;
  std::string output_format;   ///< Empty: by the ending of `output`.
  bool output_images = false;  ///< The pictures go into the MCAP file, too.
  std::string frames_csv;
  std::string tags_csv;
  std::string video;
  std::string report;
  std::string config;
  FrameOptions frames;
  MethodOptions options;
  Console console;

  /// Corners alone leave nothing but PnP.
  std::string method() const {
    if (!options.name.empty()) return options.name;
    return detections.empty() ? "blur" : "pnp";
  }
  MethodOptions method_options() const;
  /// `output` is "-": poses go to stdout, each as soon as it is known.
  bool streams_poses() const { return output == "-"; }
  /// `output` is an MCAP file, as asked for, or as its ending tells.
  bool writes_mcap() const;
  /// Of `output` where it is none: as asked for, or as its ending tells, else TUM.
  TrajectoryFormat trajectory_format() const;
};

/// Adds all options of `track`, --json and --quiet among them; `arguments` must outlive the command.
void add_track_options(CLI::App& command, TrackArguments& arguments);

}  // namespace apriltrack::app
