#include "failure.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <string_view>

#include "console.h"

namespace apriltrack::app {
namespace {

bool is_set(const CLI::App& app) {
  const CLI::Option* option = app.get_option_no_throw("--json");
  if (option != nullptr && option->count() > 0) return true;  // by a configuration file, too
  return std::ranges::any_of(app.get_subcommands(), [](const CLI::App* command) { return is_set(*command); });
}

}  // namespace

bool asks_for_json(const CLI::App& app, int argc, const char* const* argv) {
  return is_set(app) ||
         std::any_of(argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
}

void tell_machines_of_failure(std::string_view kind, int status, const std::string& message,
                              const nlohmann::json& details) {
  if (has_answered_machines()) return;
  nlohmann::json error = {{"kind", kind}, {"status", status}, {"message", message}};
  error.update(details);
  print_json(std::cout, {{"error", error}});
}

std::string_view name_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kNoResult:
      return "no_result";
    case ErrorKind::kInvalidInput:
      return "invalid_input";
    case ErrorKind::kIo:
      return "io";
  }
  return "no_result";
}

}  // namespace apriltrack::app
