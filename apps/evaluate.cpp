#include "apriltrack/base/error.h"
#include "commands.h"

namespace apriltrack::app {

void add_evaluate_command(CLI::App& app) {
  app.add_subcommand("evaluate")->callback([] { throw no_result("evaluate", "this command is being built"); });
}

}  // namespace apriltrack::app
