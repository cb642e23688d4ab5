#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "apriltrack/base/error.h"
#include "commands.h"
#include "console.h"

namespace apriltrack::app {
namespace {

constexpr int kStatusUsage = 2;
constexpr int kStatusNoResult = 1;

void add_commands(CLI::App& app) {
  app.require_subcommand(1);
  app.set_version_flag("--version", "apriltrack " APRILTRACK_VERSION);
  add_simulate_command(app);
  add_detect_command(app);
  add_calibrate_command(app);
  add_track_command(app);
  add_evaluate_command(app);
  add_map_command(app);
  add_demo_command(app);
}

int run(int argc, char** argv) {
  CLI::App app("Fiducial tracking that keeps the pose through motion blur.\n"
               "Start with: apriltrack demo --output demo-output");
  add_commands(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kStatusUsage;  // CLI11's own codes start at 100
  } catch (const Error& error) {
    std::cerr << "error: " << error.what() << '\n';
    return static_cast<int>(error.kind());
  } catch (const std::exception& error) {
    std::cerr << "internal error, please report it: " << error.what() << '\n';
    return kStatusNoResult;
  }
}

}  // namespace
}  // namespace apriltrack::app

int main(int argc, char** argv) {
  apriltrack::app::install_interrupt_handler();
  return apriltrack::app::run(argc, argv);
}
