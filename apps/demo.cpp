#include "apriltrack/base/error.h"
#include "commands.h"

namespace apriltrack::app {

void add_demo_command(CLI::App& app) {
  app.add_subcommand("demo")->callback([] { throw no_result("demo", "this command is being built"); });
}

}  // namespace apriltrack::app
