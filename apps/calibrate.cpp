#include "apriltrack/base/error.h"
#include "commands.h"

namespace apriltrack::app {

void add_calibrate_command(CLI::App& app) {
  app.add_subcommand("calibrate")->callback([] { throw no_result("calibrate", "this command is being built"); });
}

}  // namespace apriltrack::app
