#pragma once

#include <string>

#include "value_kind.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

/// Names the value of every option of every command, so that `--camera FILE` and `--tag-size METRES` are told
/// alike everywhere. Throws std::logic_error for an option that the table of value_names.cpp does not have.
void name_values(CLI::App& command);

/// Of a name that name_values() gave.
ValueKind kind_of_value(const std::string& name);

}  // namespace apriltrack::app
