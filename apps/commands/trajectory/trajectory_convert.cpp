#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/eval/trajectory_formats.h"
#include "cli/choice_option.h"
#include "cli/command_help.h"
#include "cli/console.h"
#include "cli/option_checks.h"
#include "files/format_choice.h"
#include "files/loss_words.h"
#include "files/outputs.h"
#include "files/trajectory_input.h"
#include "trajectory_command.h"

namespace apriltrack::app {
namespace {

struct ConvertOptions {
  std::string input;
  std::string output;
  std::string to;
  TrajectoryInputOptions of_input;
  std::string times;
  Console console;
};

void check_arguments(const ConvertOptions& options, TrajectoryFormat to) {
  if (!options.times.empty() && options.of_input.read.rate_hz)
    throw invalid_input("--rate", "is in place of times: give it or --times");
  std::vector<OutputFile> outputs = {{options.output, "OUT"}};
  if (to == TrajectoryFormat::kKitti) outputs.push_back({kitti_times_of(options.output, "OUT"), "OUT"});
  check_outputs(outputs, {options.input, options.times});
  check_ending(options.output, info_of(to).name, offered_formats(trajectory_formats()), "--to",
               options.console);
}

void run_convert(const ConvertOptions& options) {
  const TrajectoryFormat to =
      format_to_write(options.to, options.output, trajectory_format_named, trajectory_format_of_ending,
                      offered_formats(trajectory_formats()));
  check_arguments(options, to);
  TrajectoryInputOptions of_input = options.of_input;
  of_input.read.times = options.times;
  const TrajectoryInput reading = read_trajectory_input(options.input, of_input, options.console);
  write_trajectory_as(options.output, reading.trajectory, to);
  const std::string_view from_title = reading.title, to_title = info_of(to).title;
  nlohmann::json reported =
      report_losses(reading.losses, {.title = from_title, .file = options.input}, options.console);
  append(reported, report_losses(trajectory_losses(options.output, to),
                                 {ConversionStep::Stage::kWrite, to_title, options.output}, options.console));
  options.console.finish({{"input", options.input},
                          {"output", options.output},
                          {"from", reading.format},
                          {"to", info_of(to).name},
                          {"poses", reading.trajectory.size()},
                          {"losses", reported}},
                         fmt::format("{}: {} poses, a {} from a {}", options.output,
                                     reading.trajectory.size(), to_title, from_title));
}

}  // namespace

void add_trajectory_convert(CLI::App& trajectory_command) {
  CLI::App& verb = add_command(
      trajectory_command, "convert",
      {"Writes a trajectory in another format, and reports what that cannot hold.",
       "apriltrack trajectory convert camera.tum camera.csv\n"
       "apriltrack trajectory convert camera.tum camera.kitti\n"
       "apriltrack trajectory convert 00.txt 00.tum --times times.txt\n"
       "apriltrack trajectory convert mocap.bag truth.tum --topic /vicon/head/pose\n"
       "apriltrack trajectory convert robot.bag robot.tum --topic /tf --transform odom:base_link",
       "IN is of any known format, recognised by its content (docs/file_formats.md). Formats, for "
       "--to: " +
           list_of(offered_formats(trajectory_formats())) + "."});
  auto options = std::make_shared<ConvertOptions>();
  verb.add_option("IN", options->input, "Trajectory to read, or a bag with poses")->required();
  verb.add_option(
          "OUT", options->output,
          "Trajectory to write; KITTI's times go beside it, into OUT without its ending and .times.txt")
      ->required();
  offer_words(
      *verb.add_option(
          "--to", options->to,
          "Format of OUT; by default by its ending: .tum tum, .csv euroc, .kitti and kitti.txt kitti"),
      "FORMAT", names_of(offered_formats(trajectory_formats())));
  verb.add_option("--topic", options->of_input.bag.topic,
                  "Of a bag: the topic with poses, where there are several");
  verb.add_option("--transform", options->of_input.bag.transform,
                  "Of a bag's transforms (tf): PARENT:CHILD, the frames that they lead between, where there "
                  "are several pairs; poses are T_parent_child");
  verb.add_option("--times", options->times,
                  "Of KITTI's poses, which have no times: a file with one in seconds a line; by default "
                  "IN without its ending and .times.txt, else times.txt beside IN");
  verb.add_option("--rate", options->of_input.read.rate_hz,
                  "Of KITTI's poses, in place of times: poses a second, from 0 on")
      ->check(rate());
  options->console.add_options(verb);
  verb.callback([options] { run_convert(*options); });
}

}  // namespace apriltrack::app
