#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>

namespace apriltrack::app {
namespace {

bool is_plain(char c) {
  constexpr std::string_view kOthers = "_-./:=,+@%";
  const bool is_letter_or_digit = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  return is_letter_or_digit || kOthers.find(c) != std::string_view::npos;
}

/// In single quotes where a POSIX shell would make something else of it.
std::string quoted_for_shell(const std::string& word) {
  if (!word.empty() && std::ranges::all_of(word, is_plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

void add_word(std::string& line, const std::string& word) {
  if (!line.empty()) line += ' ';
  line += quoted_for_shell(word);
}

}  // namespace

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) add_word(line, word);
  return line;
}

std::string command_line_of(const CLI::App& command) {
  std::string line = "apriltrack " + command.get_name();
  for (const bool is_positional : {true, false}) {
    for (const CLI::Option* option : command.get_options()) {
      if (option->count() == 0 || option->get_positional() != is_positional) continue;
      if (!is_positional) add_word(line, option->get_name());
      const bool is_flag = option->get_expected_max() == 0;
      if (is_flag) continue;
      for (const std::string& word : option->results()) add_word(line, word);
    }
  }
  return line;
}

}  // namespace apriltrack::app
