#include "apriltrack/base/error.h"
#include "commands.h"

namespace apriltrack::app {

void add_track_command(CLI::App& app) {
  app.add_subcommand("track")->callback([] { throw no_result("track", "this command is being built"); });
}

}  // namespace apriltrack::app
