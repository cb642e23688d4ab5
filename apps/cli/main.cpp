#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "apriltrack/source/decoder_messages.h"
#include "commands.h"
#include "console.h"
#include "failure.h"
#include "replaced_pattern.h"

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

/// CLI11 says "Could not convert: --tag-size = 0,16".
std::string text_of_conversion(const std::string& told) {
  const std::string begin = "Could not convert: ";
  const std::size_t equals = told.find(" = ");
  if (!told.starts_with(begin) || equals == std::string::npos) return told;
  const std::string value = told.substr(equals + 3);
  return fmt::format("{}: '{}' is not a number{}", told.substr(begin.size(), equals - begin.size()), value,
                     value.find(',') == std::string::npos ? "" : "; decimals take a point, as 0.16");
}

std::string text_of(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::Option* option = given_too_often(app);
  if (option == nullptr) return text_of_conversion(error.what());
  return fmt::format("{}: is given {} times ('{}'): give it once", option->get_name(),
                     option->results().size(), fmt::join(option->results(), "', '"));
}

/// CLI11 speaks of what is missing before it speaks of what it did not understand; users mistype more often.
int tell_usage_error(const CLI::App& app, const CLI::ParseError& error) {
  if (const CLI::App* parent = without_command(app)) return tell_of_commands(*parent, app.remaining(true));
  const std::vector<std::string> strays = app.remaining(true);
  if (const auto told = told_of_replaced_pattern(strays, 1)) {
    std::cerr << "error: INPUT is one, and " << strays.size() << " more are given: " << *told << '\n';
    return kStatusUsage;
  }
  std::cerr << "error: " << text_of(app, error) << '\n';
  if (!strays.empty()) std::cerr << "not understood: " << fmt::format("{}", fmt::join(strays, " ")) << '\n';
  std::cerr << "Run with --help for more information.\n";
  return kStatusUsage;
}

/// How a run failed.
struct Failure {
  std::string_view kind;
  int status = 0;
  std::string message;
  nlohmann::json details = nlohmann::json::object();
};

Failure failure_of(const Error& error) {
  return {name_of(error.kind()), static_cast<int>(error.kind()), error.what()};
}

/// To people, and to machines if they asked.
int tell(const Failure& failure, bool is_for_machines, std::string_view begin = "error: ") {
  std::cerr << begin << failure.message << '\n';
  if (is_for_machines)
    tell_machines_of_failure(failure.kind, failure.status, failure.message, failure.details);
  return failure.status;
}

int run(int argc, char** argv) {
  CLI::App app;
  add_all_commands(app);
  const auto is_for_machines = [&] { return asks_for_json(app, argc, argv); };
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    const bool is_answer = error.get_exit_code() == 0;  // --help and --version; CLI11's failures start at 100
    if (is_answer && error.get_name() == "CallForVersion" && is_for_machines()) {
      print_json(std::cout, nlohmann::json::object());
      return 0;
    }
    if (is_answer) return app.exit(error);
    const int status = tell_usage_error(app, error);
    if (is_for_machines())
      tell_machines_of_failure(name_of(ErrorKind::kInvalidInput), status, text_of(app, error));
    return status;
  } catch (const DetailedError& error) {
    Failure failure = failure_of(error);
    failure.details = error.details();
    return tell(failure, is_for_machines());
  } catch (const Error& error) {
    return tell(failure_of(error), is_for_machines());
  } catch (const std::filesystem::filesystem_error& error) {
    return tell({name_of(ErrorKind::kIo), static_cast<int>(ErrorKind::kIo),
                 error.path1().string() + ": " + error.code().message()},
                is_for_machines());
  } catch (const std::exception& error) {
    return tell({"internal", kStatusNoResult, error.what()}, is_for_machines(),
                "internal error, please report it: ");
  }
}

}  // namespace
}  // namespace apriltrack::app

int main(int argc, char** argv) {
  apriltrack::silence_decoders();  // what they find is told in our own words
  apriltrack::app::install_interrupt_handler();
  std::signal(SIGPIPE,
              SIG_IGN);  // a reader that goes away is an output that cannot be written; files are kept
  const apriltrack::UnpackedBags kept;  // commands open their input several times
  return apriltrack::app::run(argc, argv);
}
