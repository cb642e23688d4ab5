#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>

#include "apriltrack/base/error.h"
#include "apriltrack/source/decoder_messages.h"
#include "commands.h"
#include "console.h"

namespace apriltrack::app {
namespace {

constexpr int kStatusUsage = 2;
constexpr int kStatusNoResult = 1;

std::string list_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The command whose own command is missing or not known; nullptr when they are all there.
const CLI::App* without_command(const CLI::App& app) {
  if (app.get_require_subcommand_min() == 0) return nullptr;
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? &app : without_command(*chosen.front());
}

int tell_of_commands(const CLI::App& app, const std::vector<std::string>& strays) {
  const auto word = std::find_if(strays.begin(), strays.end(), [](const auto& s) { return s[0] != '-'; });
  if (word == strays.end()) {
    std::cerr << "error: " << app.get_name() << ": a command is missing";
    if (!strays.empty()) std::cerr << " (not understood: " << strays.front() << ")";
  } else {
    std::cerr << "error: " << app.get_name() << ": there is no command '" << *word << "'";
  }
  std::cerr << "; there are: " << list_of_commands(app) << "\nRun with --help for more information.\n";
  return kStatusUsage;
}

/// An option of the commands chosen that takes one value and was given several; nullptr where there is none.
const CLI::Option* given_too_often(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const bool takes_one = option->get_expected_max() == 1;
    if (takes_one && option->results().size() > 1) return option;
  }
  for (const CLI::App* command : app.get_subcommands()) {
    if (const CLI::Option* option = given_too_often(*command)) return option;
  }
  return nullptr;
}

std::string text_of(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::Option* option = given_too_often(app);
  if (option == nullptr) return error.what();
  return fmt::format("{}: is given {} times ('{}'): give it once", option->get_name(),
                     option->results().size(), fmt::join(option->results(), "', '"));
}

/// CLI11 speaks of what is missing before it speaks of what it did not understand; users mistype more often.
int tell_usage_error(const CLI::App& app, const CLI::ParseError& error) {
  if (const CLI::App* parent = without_command(app)) return tell_of_commands(*parent, app.remaining(true));
  std::cerr << "error: " << text_of(app, error) << '\n';
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
  apriltrack::silence_decoders();  // what they find is told in our own words
  apriltrack::app::install_interrupt_handler();
  return apriltrack::app::run(argc, argv);
}
