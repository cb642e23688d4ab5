#include "manual_page.h"

#include <fmt/format.h>

#include "apriltrack/base/version.h"
#include "help_text.h"
#include "text_flow.h"

namespace apriltrack::app {
namespace {

/// Characters that roff would take for its own; a line must not begin with a control character.
std::string escaped(const std::string& text) {
  std::string roff;
  for (const char c : text) {
    if (c == '\\') {
      roff += "\\e";
    } else if (c == '-') {
      roff += "\\-";  // a hyphen that can be copied into a shell
    } else {
      roff += c;
    }
  }
  const bool looks_like_request = !roff.empty() && (roff.front() == '.' || roff.front() == '\'');
  return looks_like_request ? "\\&" + roff : roff;
}

std::string as_written(const std::vector<std::string>& lines) {
  std::string roff = ".nf\n";
  for (const std::string& line : lines) roff += escaped(line) + "\n";
  return roff + ".fi\n";
}

std::string paragraphs(const std::string& text) {
  std::string roff;
  std::vector<std::string> list;
  const auto end_list = [&] {
    if (!list.empty()) roff += ".PP\n" + as_written(list);
    list.clear();
  };
  for (const std::string& block : flowing_lines(text)) {
    const bool is_of_list = !block.empty() && block.front() == ' ';
    if (is_of_list) {
      list.push_back(block);
      continue;
    }
    end_list();
    if (!block.empty()) roff += ".PP\n" + escaped(block) + "\n";
  }
  end_list();
  return roff;
}

std::string tagged(const std::string& name, const std::string& help) {
  return ".TP\n.B " + escaped(name) + "\n" + escaped(help) + "\n";
}

std::string options(const std::string& title, const std::vector<OptionRow>& rows) {
  if (rows.empty()) return "";
  std::string roff = ".SH " + title + "\n";
  for (const OptionRow& row : rows) roff += tagged(form_of(row), full_help_of(row));
  return roff;
}

std::string commands(const CommandTable& command) {
  if (command.commands.empty()) return "";
  std::string roff = ".SH COMMANDS\n";
  for (const CommandTable& own : command.commands)
    roff += tagged(joined(own.words, "-") + "(1)", own.summary);
  return roff;
}

std::string see_also(const CommandTable& command) {
  if (command.words.size() == 1) return "";
  std::vector<std::string> parents = command.words;
  parents.pop_back();
  return ".SH SEE ALSO\n.BR " + escaped(joined(parents, "-")) + " (1)\n";
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n"
    ".TP\n.B 0\nThere is a result; warnings may have been told.\n"
    ".TP\n.B 1\nThere is none: no tags, no pose in any frame, tags that nothing joins.\n"
    ".TP\n.B 2\nThe command line, an option, or the contents of a file is wrong.\n"
    ".TP\n.B 3\nAn input or output cannot be opened, read or written.\n";

}  // namespace

std::string manual_page(const CommandTable& command) {
  const std::string name = joined(command.words, "-");
  std::string upper = name;
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  // apriltrack(1) alone has its summary in two lines, of which the first names it.
  const std::string summary = command.summary.substr(0, command.summary.find('\n'));
  std::string roff =
      fmt::format(".TH \"{}\" \"1\" \"\" \"apriltrack {}\" \"AprilTrack\"\n", escaped(upper), version());
  roff += ".SH NAME\n" + escaped(name) + " \\- " + escaped(summary) + "\n";
  roff += ".SH SYNOPSIS\n.B " + escaped(usage_of(command)) + "\n";
  roff += ".SH DESCRIPTION\n" + escaped(summary) + "\n" + paragraphs(command.details);
  roff += options("ARGUMENTS", command.positionals) + options("OPTIONS", command.options) + commands(command);
  if (!command.examples.empty()) roff += ".SH EXAMPLES\n" + as_written(command.examples);
  return roff + kExitStatus + see_also(command);
}

std::vector<ManualFile> manual_files(const CommandTable& command) {
  std::vector<ManualFile> files = {{joined(command.words, "-") + ".1", manual_page(command)}};
  for (const CommandTable& own : command.commands) {
    std::vector<ManualFile> below = manual_files(own);
    std::move(below.begin(), below.end(), std::back_inserter(files));
  }
  return files;
}

}  // namespace apriltrack::app
