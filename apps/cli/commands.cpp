#include "commands.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "apriltrack/base/version.h"
#include "command_help.h"
#include "option_checks.h"
#include "value_names.h"

namespace apriltrack::app {
namespace {

/// No option means anything by an empty text; a script's variable that is not set means a mistake.
void refuse_empty_texts(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_expected_max() > 0) option->check(not_empty("leave it out, or give it a value"));
  }
  for (CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
    refuse_empty_texts(*sub);
}

/// CLI11 takes the word behind an option for its value, whatever that is: of `--output --json` a file called
/// --json.
void refuse_options_as_values(CLI::App& command) {
  for (CLI::Option* option : command.get_options()) {
    if (option->get_expected_max() > 0 && !option->get_positional()) option->check(no_option_of(command));
  }
  for (CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
    refuse_options_as_values(*sub);
}

}  // namespace

void add_all_commands(CLI::App& app) {
  app.name("apriltrack");  // not the path by which it was called
  set_help(app, {"Fiducial tracking that keeps the pose through motion blur.",
                 "apriltrack demo --output demo-output\n"
                 "apriltrack help track",
                 ""});
  app.require_subcommand(1);
  app.set_version_flag("-v,--version", std::string("apriltrack ") + version(),
                       "Print name and version, with --json as data");
  add_simulate_command(app);
  add_doctor_command(app);
  add_detect_command(app);
  add_calibrate_command(app);
  add_track_command(app);
  add_evaluate_command(app);
  add_map_command(app);
  add_camera_command(app);
  add_trajectory_command(app);
  add_demo_command(app);
  add_help_command(app);
  add_completion_command(app);
  name_values(app);
  refuse_empty_texts(app);
  refuse_options_as_values(app);
}

void run_command(std::vector<std::string> words) {
  CLI::App app;
  add_all_commands(app);
  std::reverse(words.begin(), words.end());  // the order in which CLI11 takes words off a vector
  app.parse(words);
}

}  // namespace apriltrack::app
