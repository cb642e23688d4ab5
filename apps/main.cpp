#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iostream>

#include "apriltrack/base/error.h"
#include "commands.h"
#include "console.h"

namespace apriltrack::app {
namespace {

constexpr int kStatusUsage = 2;
constexpr int kStatusNoResult = 1;

/// CLI11 speaks of what is missing before it speaks of what it did not understand; users mistype more often.
int tell_usage_error(const CLI::App& app, const CLI::ParseError& error) {
  std::cerr << "error: " << error.what() << '\n';
  const std::vector<std::string> strays = app.remaining(true);
  if (!strays.empty()) std::cerr << "not understood: " << fmt::format("{}", fmt::join(strays, " ")) << '\n';
  std::cerr << "Run with --help for more information.\n";
  return kStatusUsage;
}

int run(int argc, char** argv) {
  CLI::App app;
  add_all_commands(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    const bool is_answer = error.get_exit_code() == 0;  // --help and --version; CLI11's failures start at 100
    return is_answer ? app.exit(error) : tell_usage_error(app, error);
  } catch (const Error& error) {
    std::cerr << "error: " << error.what() << '\n';
    return static_cast<int>(error.kind());
  } catch (const std::filesystem::filesystem_error& error) {
    std::cerr << "error: " << error.path1().string() << ": " << error.code().message() << '\n';
    return static_cast<int>(ErrorKind::kIo);
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
