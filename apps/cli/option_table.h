#pragma once

#include <string>
#include <vector>

#include "value_kind.h"

namespace CLI {
class App;
}

namespace apriltrack::app {

// The command line as data: what `--help`, the manual pages and the completions of the shells are written
// from.

/// An option, or (without names) a positional word.
struct OptionRow {
  std::vector<std::string> names;  ///< "-h", "--help"; empty of a positional word.
  std::string value;               ///< "FILE", "METRES", "ego|joint"; empty of a flag.
  ValueKind kind = ValueKind::kNone;
  std::vector<std::string> choices;  ///< Of kChoice: the words it may be.
  std::string preset;                ///< What holds where it is left out, as written; may be empty.
  std::string help;
  bool is_required = false;
  bool is_repeatable = false;
};

/// A command, or a command's own command.
struct CommandTable {
  std::vector<std::string> words;  ///< "apriltrack", "map", "convert".
  std::string summary;             ///< One line.
  std::string
      details;  ///< Further paragraphs; lines that begin with blanks, and those of a list, stay as they are.
  std::vector<std::string> examples;
  std::vector<OptionRow> positionals;
  std::vector<OptionRow> options;
  std::vector<CommandTable> commands;
};

/// Of a command after add_command() and add_all_commands(). parents: the words before its own.
CommandTable option_table(const CLI::App& command, const std::vector<std::string>& parents = {});

/// "apriltrack map convert", or with other glue "apriltrack-map-convert".
std::string joined(const std::vector<std::string>& words, const std::string& glue = " ");

}  // namespace apriltrack::app
