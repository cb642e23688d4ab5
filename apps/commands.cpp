#include "commands.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "apriltrack/base/version.h"
#include "option_checks.h"

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

}  // namespace

void add_all_commands(CLI::App& app) {
  app.name("apriltrack");  // not the path by which it was called
  app.description(
      "Fiducial tracking that keeps the pose through motion blur.\n"
      "Start with: apriltrack demo --output demo-output");
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("apriltrack ") + version());
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
  refuse_empty_texts(app);
}

void run_command(std::vector<std::string> words) {
  CLI::App app;
  add_all_commands(app);
  std::reverse(words.begin(), words.end());  // the order in which CLI11 takes words off a vector
  app.parse(words);
}

}  // namespace apriltrack::app
