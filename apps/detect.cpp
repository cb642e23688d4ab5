#include "apriltrack/base/error.h"
#include "commands.h"

namespace apriltrack::app {

void add_detect_command(CLI::App& app) {
  app.add_subcommand("detect")->callback([] { throw no_result("detect", "this command is being built"); });
}

}  // namespace apriltrack::app
