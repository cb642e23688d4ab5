#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/camera/response_tables.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/staged_files.h"
#include "apriltrack/source/bag_input.h"
#include "camera_command.h"
#include "cli/choice_option.h"
#include "cli/command_help.h"
#include "cli/console.h"
#include "files/format_choice.h"
#include "files/inputs.h"
#include "files/loss_words.h"
#include "files/outputs.h"

namespace apriltrack::app {
namespace {

struct ConvertOptions {
  std::string input;
  std::string topic;
  std::string output;
  std::string to;
  std::string camera_name;
  std::string resolution;
  bool may_fit = false;
  Console console;
};

struct Size {
  int width = 0;
  int height = 0;
};

constexpr long long kMaxSide = 100'000;

/// 0 where the text is none.
int side_of(std::string_view text) {
  const long long side = parse_integer(text).value_or(0);
  return side >= 1 && side <= kMaxSide ? static_cast<int>(side) : 0;
}

Size size_of(const std::string& text) {
  const std::string_view view = text;
  const std::size_t x = std::min(view.find_first_of("xX"), view.size());
  const Size size{side_of(view.substr(0, x)), side_of(view.substr(std::min(x + 1, view.size())))};
  if (size.width > 0 && size.height > 0) return size;
  throw invalid_input(
      "--resolution",
      fmt::format("must be WIDTHxHEIGHT in pixels, each from 1 to {}, such as 1280x720 (is '{}')", kMaxSide,
                  text));
}

/// Of cameras whose file tells none.
void give_resolution(CameraRig& rig, const std::string& text) {
  const Size size = size_of(text);
  for (Camera& camera : rig.cameras) {
    const bool is_told = camera.width > 0;
    if (is_told && (camera.width != size.width || camera.height != size.height)) {
      throw invalid_input(
          "--resolution",
          fmt::format("is {} x {}, but the file says {} x {} for camera '{}', whose numbers hold for that "
                      "size alone",
                      size.width, size.height, camera.width, camera.height, camera.name));
    }
    camera.width = size.width;
    camera.height = size.height;
  }
}

std::string summary_of(const std::vector<ConversionLoss>& read, const std::vector<ConversionLoss>& written) {
  const auto num_unread = std::ranges::count(written, LossKind::kUnreadLens, &ConversionLoss::kind);
  const auto num_lost = std::ssize(read) + std::ssize(written) - num_unread;
  if (num_lost > 0) return fmt::format("not kept: {}", num_lost);
  return num_unread > 0 ? "not for every reader: see the warnings" : "nothing was lost";
}

/// OUT, and the response tables that are written beside it; none of them is a file that IN is made of.
void check_files(const ConvertOptions& options, const CameraRig& rig, CameraFormat to) {
  std::vector<std::string> inputs = {options.input};
  if (!is_bag_input(options.input)) {
    for (const auto& table : response_tables(options.input)) inputs.push_back(table.string());
  }
  check_output(options.output, "OUT", inputs);
  if (to != CameraFormat::kKalibr || is_written_directly(options.output)) return;
  CameraRig written = rig;
  std::erase_if(written.cameras, [&](const Camera& camera) {
    return !options.camera_name.empty() && camera.name != options.camera_name;
  });
  for (const auto& table : response_tables_to_write(options.output, written))
    check_output(table.string(), "response table beside OUT", inputs);
}

void run_convert(const ConvertOptions& options) {
  CameraFile file = read_camera_input(options.input, options.topic, options.console,
                                      options.may_fit ? BeyondOurLenses::kFit : BeyondOurLenses::kRefuse);
  const CameraFormat to = format_to_write(options.to, options.output, camera_format_named,
                                          camera_format_of_ending, offered_formats(camera_formats()));
  check_files(options, file.rig, to);
  check_ending(options.output, info_of(to).name, offered_formats(camera_formats()), "--to", options.console);
  if (!options.camera_name.empty()) camera_named(file.rig, options.camera_name, options.input);
  if (!options.resolution.empty()) give_resolution(file.rig, options.resolution);
  const std::vector<ConversionLoss> losses =
      write_cameras_as(options.output, file.rig, to, options.camera_name);
  const std::string_view from_title = info_of(file.format).title, to_title = info_of(to).title;
  nlohmann::json reported =
      report_losses(file.lost, {.title = from_title, .file = options.input}, options.console);
  append(reported,
         report_losses(losses, {ConversionStep::Stage::kWrite, to_title, options.output}, options.console));
  options.console.finish({{"input", options.input},
                          {"output", options.output},
                          {"from", info_of(file.format).name},
                          {"to", info_of(to).name},
                          {"losses", reported}},
                         fmt::format("{}: {}, from {}; {}", options.output, to_title, from_title,
                                     summary_of(file.lost, losses)));
}

}  // namespace

void add_camera_convert(CLI::App& camera_command) {
  CLI::App& verb =
      add_command(camera_command, "convert",
                  {"Writes the cameras of a file in another format, and reports what that cannot hold.",
                   "apriltrack camera convert left.cameramodel camera.yaml\n"
                   "apriltrack camera convert camera.yaml camera_info.yaml --to ros\n"
                   "apriltrack camera convert recording.mcap camera.yaml --topic /left/image_raw\n"
                   "apriltrack camera convert photonvision.json cameras.txt --resolution 1280x720",
                   "IN is of any known format, recognised by its content (docs/file_formats.md), or a bag "
                   "with CameraInfo. "
                   "Formats that "
                   "are written, for --to: " +
                       list_of(offered_formats(camera_formats())) + "."});
  auto options = std::make_shared<ConvertOptions>();
  verb.add_option("IN", options->input, "Camera file to read, or a bag with CameraInfo")->required();
  verb.add_option("OUT", options->output, "Camera file to write")->required();
  offer_words(
      *verb.add_option(
          "--to", options->to,
          "Format of OUT; by default by its ending: .yaml and .yml kalibr, .cameramodel mrcal, .txt colmap"),
      "FORMAT", names_of(offered_formats(camera_formats())));
  verb.add_option(
      "--camera-name", options->camera_name,
      "Camera of a rig to write alone; by default all, or the first where the format is of one camera");
  verb.add_option("--topic", options->topic, kTopicOfCamera);
  verb.add_option("--resolution", options->resolution, "WIDTHxHEIGHT in pixels, where IN does not state it");
  verb.add_flag("--fit", options->may_fit,
                "Takes the nearest lens of 8 coefficients where IN has OpenCV's thin prism or tilted sensor, "
                "if it is off "
                "by no more than 0.5 px, and reports by how much");
  options->console.add_options(verb);
  verb.callback([options] { run_convert(*options); });
}

}  // namespace apriltrack::app
