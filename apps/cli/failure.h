#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "apriltrack/base/error.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

/// An Error with more to tell to machines than its sentence.
class DetailedError : public Error {
 public:
  /// details: an object, whose members join those of "error".
  DetailedError(const Error& error, nlohmann::json details) : Error(error), details_(std::move(details)) {}

  const nlohmann::json& details() const { return details_; }

 private:
  nlohmann::json details_;
};

/// Whether --json was asked for, of any command chosen or, where the command line was not understood, by the
/// word alone.
bool asks_for_json(const CLI::App& app, int argc, const char* const* argv);

/// {"error": {"kind", "status", "message", ...}} on stdout, where no answer went there before.
void tell_machines_of_failure(std::string_view kind, int status, const std::string& message,
                              const nlohmann::json& details = nlohmann::json::object());

/// "no_result", "invalid_input" or "io".
std::string_view name_of(ErrorKind kind);

}  // namespace apriltrack::app
