#include "help_text.h"

#include <algorithm>

#include "text_flow.h"

namespace apriltrack::app {
namespace {

constexpr std::size_t kNameColumn = 2;
constexpr std::size_t kOptionColumn = 28;
constexpr std::size_t kCommandColumn = 16;

/// "  NAME        what it is", the help wrapped in its own column.
std::string entry(const std::string& name, const std::string& help, std::size_t column, std::size_t width) {
  std::string text = std::string(kNameColumn, ' ') + name;
  const bool fits = text.size() + 2 <= column;
  if (fits) {
    text.resize(column, ' ');
  } else {
    text += "\n" + std::string(column, ' ');
  }
  return text + wrapped(help, width, column, column) + "\n";
}

std::string list_of_options(const std::string& title, const std::vector<OptionRow>& rows, std::size_t width) {
  if (rows.empty()) return "";
  std::string text = title + ":\n";
  for (const OptionRow& row : rows) text += entry(form_of(row), full_help_of(row), kOptionColumn, width);
  return text + "\n";
}

std::string list_of_commands(const std::vector<CommandTable>& commands, std::size_t width) {
  if (commands.empty()) return "";
  std::string text = "Commands:\n";
  for (const CommandTable& command : commands)
    text += entry(command.words.back(), command.summary, kCommandColumn, width);
  return text + "\n";
}

std::string list_of_examples(const std::vector<std::string>& examples) {
  if (examples.empty()) return "";
  std::string text = "Example:\n";
  for (const std::string& example : examples) text += "  " + example + "\n";
  return text + "\n";
}

/// Where the text of "  name   text" begins; of a line without two columns four more than its own blanks.
std::size_t second_column(const std::string& line) {
  const std::size_t name = line.find_first_not_of(' ');
  const std::size_t gap = line.find("  ", name);
  return gap == std::string::npos ? name + 4 : line.find_first_not_of(' ', gap);
}

/// A line of a list: its second column goes on below itself. A command line is not cut.
std::string list_line(const std::string& line, std::size_t width) {
  const std::size_t column = line.empty() ? 0 : second_column(line);
  const bool is_command_line = line.find("  apriltrack ") == 0;
  if (line.size() <= width || is_command_line || column >= width / 2) return line;
  return line.substr(0, column) + wrapped(line.substr(column), width, column, column);
}

std::string flowing(const std::string& text, std::size_t width) {
  std::string lines;
  for (const std::string& block : flowing_lines(text)) {
    const bool is_of_list = block.empty() || block.front() == ' ';
    lines += (is_of_list ? list_line(block, width) : wrapped(block, width, 0, 0)) + "\n";
  }
  return lines.empty() ? lines : lines + "\n";
}

}  // namespace

std::string usage_of(const CommandTable& command) {
  std::string usage = joined(command.words) + " [OPTIONS]";
  for (const OptionRow& word : command.positionals)
    usage +=
        " " + (word.is_required ? word.value : "[" + word.value + "]") + (word.is_repeatable ? "..." : "");
  return command.commands.empty() ? usage : usage + " COMMAND";
}

std::string form_of(const OptionRow& option) {
  std::string form = joined(option.names, ", ");
  if (!option.value.empty()) form += (form.empty() ? "" : " ") + option.value;
  return form + (option.is_repeatable ? "..." : "");
}

std::string full_help_of(const OptionRow& option) {
  std::string help = option.help;
  if (option.is_required && !option.names.empty()) help += " (required)";
  if (!option.preset.empty()) help += " (default: " + option.preset + ")";
  return help;
}

std::string help_text(const CommandTable& command, std::size_t width) {
  std::string text =
      list_of_examples(command.examples) + flowing(command.summary, width) + flowing(command.details, width) +
      "Usage: " + usage_of(command) + "\n\n" + list_of_options("Arguments", command.positionals, width) +
      list_of_options("Options", command.options, width) + list_of_commands(command.commands, width);
  text.pop_back();  // the empty line behind the last list
  return text;
}

}  // namespace apriltrack::app
