#include "track_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <vector>

#include "apriltrack/base/error.h"
#include "cli/option_checks.h"
#include "files/format_choice.h"
#include "files/inputs.h"
#include "files/outputs.h"
#include "track_outputs.h"

namespace apriltrack::app {
namespace {

/// An option that not every method asks for.
struct MethodsOwnOption {
  const char* name;
  std::vector<std::string> methods;
};

const std::array<MethodsOwnOption, 3> kMethodsOwnOptions = {
    {{"--paper-variant", {"paper"}}, {"--particles", {"blur", "paper"}}, {"--seed", {"blur", "paper"}}}};

/// Who gives an option means it: one that changes nothing shows that another method was meant.
void refuse_options_of_other_methods(const CLI::App& command, const std::string& method) {
  for (const MethodsOwnOption& option : kMethodsOwnOptions) {
    if (command.get_option(option.name)->count() == 0) continue;
    if (std::ranges::find(option.methods, method) != option.methods.end()) continue;
    throw invalid_input(option.name,
                        fmt::format("is of --method {} and would change nothing with --method {}: leave it "
                                    "out, or choose the method that is meant",
                                    fmt::join(option.methods, " and "), method));
  }
}

/// stdout has room for one of them.
void check_streaming(const TrackArguments& arguments) {
  if (arguments.console.is_json())
    throw invalid_input("--output",
                        "- gives stdout to the poses, and so does --json to its answer: leave out "
                        "--json, or name a file");
  if (!arguments.output_format.empty() && arguments.output_format != "tum")
    throw invalid_input("--output-format",
                        fmt::format("{} cannot be written to - pose by pose: leave it out, or name a file",
                                    arguments.output_format));
  leave_stdout_to_output();
}

}  // namespace

void check_track_arguments(const CLI::App& command, const TrackArguments& arguments) {
  if (arguments.input.empty() == arguments.detections.empty()) {
    throw invalid_input("track", "give either INPUT or --detections FILE");
  }
  if (!arguments.detections.empty()) {
    if (arguments.method() != "pnp") {
      throw invalid_input("--detections",
                          fmt::format("is for --method pnp: '{}' looks at images", arguments.method()));
    }
    refuse_beside_detections(command, kFrameOptionNames);
    refuse_beside_detections(command,
                             {"--decimate", "--min-margin", "--max-hamming", "--video", "--output-images"});
  }
  refuse_options_of_other_methods(command, arguments.method());
  if (arguments.streams_poses()) check_streaming(arguments);
  if (!arguments.input.empty()) check_input(arguments.input);
  std::vector<std::string> read = camera_inputs(arguments.camera, {arguments.input});
  read.insert(read.end(), {arguments.input, arguments.detections, arguments.map,
                           arguments.map_input.tag_sizes, arguments.config});
  check_outputs(output_files(arguments), read);
  if (!arguments.output_format.empty())
    check_ending(arguments.output, arguments.output_format, offered_formats(trajectory_formats()),
                 "--output-format", arguments.console);
  if (arguments.output_images && !arguments.writes_mcap())
    throw invalid_input(
        "--output-images",
        fmt::format("puts the pictures into an MCAP file, and '{}' is none: leave it out, name "
                    "a file that ends in .mcap, or give --output-format mcap",
                    arguments.output));
  if (!arguments.video.empty() && std::filesystem::path(arguments.video).extension() != ".mp4")
    throw invalid_input("--video", fmt::format("'{}' must end in .mp4", arguments.video));
}

}  // namespace apriltrack::app
