#include <CLI/CLI.hpp>

#include "camera_command.h"
#include "cli/command_help.h"
#include "cli/commands.h"

namespace apriltrack::app {

void add_camera_command(CLI::App& app) {
  CLI::App& command = add_command(app, "camera",
                                  {"Shows camera files of every known format, and converts them.",
                                   "apriltrack camera show camera_info.yaml\n"
                                   "apriltrack camera convert left.cameramodel camera.yaml",
                                   ""});
  command.require_subcommand(1);
  add_camera_show(command);
  add_camera_convert(command);
}

}  // namespace apriltrack::app
