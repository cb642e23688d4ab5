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

int run(int argc, char** argv) {
  CLI::App app;
  add_all_commands(app);
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
