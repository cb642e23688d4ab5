#include <CLI/CLI.hpp>

#include "cli/command_help.h"
#include "cli/commands.h"
#include "trajectory_command.h"

namespace apriltrack::app {

void add_trajectory_command(CLI::App& app) {
  CLI::App& command = add_command(app, "trajectory",
                                  {"Converts trajectories of every known format.",
                                   "apriltrack trajectory convert camera.tum camera.csv\n"
                                   "apriltrack trajectory convert 00.txt 00.tum --times times.txt",
                                   ""});
  command.require_subcommand(1);
  add_trajectory_convert(command);
}

}  // namespace apriltrack::app
