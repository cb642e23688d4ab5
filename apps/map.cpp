#include "apriltrack/base/error.h"
#include "commands.h"

namespace apriltrack::app {

void add_map_command(CLI::App& app) {
  app.add_subcommand("map")->callback([] { throw no_result("map", "this command is being built"); });
}

}  // namespace apriltrack::app
