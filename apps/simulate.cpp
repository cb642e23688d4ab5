#include "apriltrack/base/error.h"
#include "commands.h"

namespace apriltrack::app {

void add_simulate_command(CLI::App& app) {
  app.add_subcommand("simulate")->callback([] { throw no_result("simulate", "this command is being built"); });
}

}  // namespace apriltrack::app
