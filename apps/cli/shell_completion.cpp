#include "shell_completion.h"

#include <fmt/format.h>

#include <functional>

namespace apriltrack::app {
namespace {

void for_each_command(const CommandTable& command, const std::function<void(const CommandTable&)>& visit) {
  visit(command);
  for (const CommandTable& own : command.commands) for_each_command(own, visit);
}

std::vector<std::string> names_of(const std::vector<CommandTable>& commands) {
  std::vector<std::string> names;
  for (const CommandTable& command : commands) names.push_back(command.words.back());
  return names;
}

std::vector<std::string> names_of(const std::vector<OptionRow>& options) {
  std::vector<std::string> names;
  for (const OptionRow& option : options) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

bool is_path(ValueKind kind) {
  return kind == ValueKind::kFile || kind == ValueKind::kFolder || kind == ValueKind::kInput;
}

// ---- bash

/// What completes a value: a line of bash.
std::string bash_values(const OptionRow& option) {
  switch (option.kind) {
    case ValueKind::kChoice:
      return fmt::format("_apriltrack_words '{}'", joined(option.choices));
    case ValueKind::kFolder:
      return "_apriltrack_paths -d";
    case ValueKind::kFile:
    case ValueKind::kInput:
      return "_apriltrack_paths -f";
    default:
      return "COMPREPLY=()";
  }
}

std::string bash_case_of(const CommandTable& command) {
  const std::string path = joined(command.words);
  std::string text;
  for (const OptionRow& option : command.options) {
    if (option.value.empty()) continue;
    std::string patterns;
    for (const std::string& name : option.names)
      patterns += fmt::format("{}'{}:{}'", patterns.empty() ? "" : "|", path, name);
    text += fmt::format("    {}) {}; return ;;\n", patterns, bash_values(option));
  }
  return text;
}

std::string bash_words_of(const CommandTable& command) {
  const std::string own = joined(names_of(command.commands));
  const bool takes_paths = !command.positionals.empty() && is_path(command.positionals.front().kind);
  return fmt::format("    '{}') options='{}'; words='{}'; paths={} ;;\n", joined(command.words),
                     joined(names_of(command.options)), own, takes_paths ? "yes" : "no");
}

constexpr const char* kBashBegin = R"(# bash completion of apriltrack; written by `apriltrack completion bash`
_apriltrack_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$current"); }
_apriltrack_paths() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen "$1" -- "$current")
}
_apriltrack() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} path=apriltrack i options words paths
  # --option=value is three words to bash
  if [[ $current == '=' ]]; then current=; elif [[ $previous == '=' ]]; then previous=${COMP_WORDS[COMP_CWORD-2]}; fi
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$path ${COMP_WORDS[i]}" in
)";

constexpr const char* kBashEnd = R"(  if [[ $current == -* ]]; then
    _apriltrack_words "$options"
  elif [[ -n $words ]]; then
    _apriltrack_words "$words"
  elif [[ $paths == yes ]]; then
    _apriltrack_paths -f
  fi
}
complete -F _apriltrack apriltrack
)";

// ---- zsh

std::string zsh_quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') quoted += '\\';
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted;
}

std::string zsh_action(const OptionRow& option) {
  switch (option.kind) {
    case ValueKind::kChoice:
      return "(" + joined(option.choices) + ")";
    case ValueKind::kFolder:
      return "_files -/";
    case ValueKind::kFile:
    case ValueKind::kInput:
      return "_files";
    default:
      return " ";
  }
}

std::string zsh_value(const OptionRow& option) {
  return option.value.empty() ? "" : fmt::format(":{}:{}", zsh_quoted(option.value), zsh_action(option));
}

std::string zsh_options(const CommandTable& command) {
  std::string text;
  for (const OptionRow& option : command.options) {
    for (const std::string& name : option.names) {
      const bool is_long = name.starts_with("--");
      text += fmt::format(" \\\n    '{}{}{}[{}]{}'", option.is_repeatable ? "*" : "", name,
                          !option.value.empty() && is_long ? "=" : "", zsh_quoted(option.help),
                          zsh_value(option));
    }
  }
  return text;
}

std::string zsh_name(const CommandTable& command) {
  return "_" + joined(command.words, "_");
}

std::string zsh_function(const CommandTable& command) {
  std::string text = zsh_name(command) + "() {\n";
  if (command.commands.empty()) {
    text += "  _arguments -s -S" + zsh_options(command);
    for (const OptionRow& word : command.positionals)
      text += fmt::format(" \\\n    '{}:{}:{}'", word.is_repeatable ? "*" : "", zsh_quoted(word.value),
                          zsh_action(word));
    return text + "\n}\n";
  }
  text += "  local -a commands\n  local curcontext=$curcontext state line\n  commands=(\n";
  for (const CommandTable& own : command.commands)
    text += fmt::format("    '{}:{}'\n", own.words.back(), zsh_quoted(own.summary));
  text +=
      "  )\n  _arguments -C -S" + zsh_options(command) + " \\\n    '1: :->command' \\\n    '*:: :->words'\n";
  text +=
      "  case $state in\n    command) _describe -t commands command commands ;;\n    words)\n      case "
      "$words[1] in\n";
  for (const CommandTable& own : command.commands)
    text += fmt::format("        {}) {} ;;\n", own.words.back(), zsh_name(own));
  return text + "      esac ;;\n  esac\n}\n";
}

// ---- fish

std::string fish_quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return "'" + quoted + "'";
}

std::string fish_option(const std::string& condition, const OptionRow& option) {
  std::string text = "complete -c apriltrack -n " + fish_quoted(condition);
  for (const std::string& name : option.names)
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (option.kind == ValueKind::kChoice) text += " -x -a " + fish_quoted(joined(option.choices));
  if (option.kind == ValueKind::kFolder) {
    text += " -x -a '(__fish_complete_directories)'";
  } else if (is_path(option.kind)) {
    text += " -r -F";
  }
  if (option.kind == ValueKind::kText) text += " -x";
  return text + " -d " + fish_quoted(option.help) + "\n";
}

std::string fish_lines_of(const CommandTable& command) {
  const std::string condition = fmt::format("test (_apriltrack_command) = \"{}\"", joined(command.words));
  std::string text;
  for (const CommandTable& own : command.commands)
    text += fmt::format("complete -c apriltrack -n {} -f -a {} -d {}\n", fish_quoted(condition),
                        own.words.back(), fish_quoted(own.summary));
  for (const OptionRow& option : command.options) text += fish_option(condition, option);
  if (!command.positionals.empty() && is_path(command.positionals.front().kind))
    text += "complete -c apriltrack -n " + fish_quoted(condition) + " -F\n";
  return text;
}

}  // namespace

std::string bash_completion(const CommandTable& program) {
  std::string paths;
  std::string values;
  std::string words;
  for_each_command(program, [&](const CommandTable& command) {
    if (command.words.size() > 1) paths += (paths.empty() ? "'" : "|'") + joined(command.words) + "'";
    values += bash_case_of(command);
    words += bash_words_of(command);
  });
  return std::string(kBashBegin) + "      " + paths + ") path+=\" ${COMP_WORDS[i]}\" ;;\n    esac\n  done\n" +
         "  case \"$path:$previous\" in\n" + values + "  esac\n  case \"$path\" in\n" + words + "  esac\n" +
         kBashEnd;
}

std::string zsh_completion(const CommandTable& program) {
  std::string text =
      "#compdef apriltrack\n# zsh completion of apriltrack; written by `apriltrack completion zsh`\n";
  for_each_command(program, [&](const CommandTable& command) { text += zsh_function(command); });
  return text + "_apriltrack \"$@\"\n";
}

std::string fish_completion(const CommandTable& program) {
  std::string paths;
  std::string lines;
  for_each_command(program, [&](const CommandTable& command) {
    if (command.words.size() > 1) paths += " \"" + joined(command.words) + "\"";
    lines += fish_lines_of(command);
  });
  return "# fish completion of apriltrack; written by `apriltrack completion fish`\n"
         "function _apriltrack_command\n"
         "  set -l path apriltrack\n"
         "  for word in (commandline -opc)[2..-1]\n"
         "    if contains -- \"$path $word\"" +
         paths +
         "\n"
         "      set path \"$path $word\"\n"
         "    end\n"
         "  end\n"
         "  echo $path\n"
         "end\n"
         "complete -c apriltrack -f\n" +
         lines;
}

}  // namespace apriltrack::app
