#include "frame_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "cli/config_file.h"
#include "cli/option_checks.h"
#include "topics.h"

namespace apriltrack::app {

void add_frame_options(CLI::App& command, FrameOptions& options) {
  SourceOptions& source = options.source;
  command.add_option("--rate", source.rate_hz, "Frames a second, for images whose names are no times")
      ->check(rate());
  add_bits_option(command, source.bits);
  add_bag_options(command, options.topics, source.stamp_is);
  command.add_option("--skip", source.skip, "Leave out so many frames at the start of each input")
      ->check(whole_number(0));
  command.add_option("--step", source.step, "Use every STEP-th frame")
      ->check(whole_number(1))
      ->capture_default_str();
  command.add_option("--max-frames", source.max_frames, "Use so many frames of each input at most")
      ->check(whole_number(1));
}

void add_config_option(CLI::App& command, std::string& config) {
  const auto apply = [&command, &config](const std::string& path) {
    config = path;
    apply_config_file(command, path);
  };
  command.add_option_function<std::string>(
      "--config", apply, "YAML file of options, keys = their long names; the command line wins");
}

void set_shutter(SourceOptions& options, const Camera& camera) {
  options.exposure_s = camera.exposure_s;
  // A sensor that is read upwards begins with the last row, and that is when its driver stamps the start.
  options.readout_s = std::max(0, camera.height - 1) * std::abs(camera.line_delay_s);
}

}  // namespace apriltrack::app
