#include "text_flow.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

namespace apriltrack::app {
namespace {

constexpr std::size_t kMostColumns = 100;
constexpr std::size_t kLeastColumns = 40;

std::size_t characters(const std::string& text) {
  const auto begins_one = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_one));
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t width, std::size_t indent,
                    std::size_t first_column) {
  std::istringstream words(text);
  std::string lines;
  std::size_t column = first_column;
  bool is_first = true;
  for (std::string word; words >> word; is_first = false) {
    const std::size_t length = characters(word);
    if (!is_first && column + 1 + length > width) {
      lines += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (!is_first) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += length;
  }
  return lines;
}

std::vector<std::string> flowing_lines(const std::string& text) {
  std::vector<std::string> blocks;
  bool may_go_on = false;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const bool flows = !line.empty() && line.front() != ' ';
    if (flows && may_go_on) {
      blocks.back() += " " + line;
    } else {
      blocks.push_back(line);
    }
    may_go_on = flows;
  }
  return blocks;
}

std::size_t terminal_width() {
  winsize size{};
  const bool is_terminal = isatty(STDOUT_FILENO) == 1 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
  if (!is_terminal || size.ws_col == 0) return kMostColumns;
  return std::clamp<std::size_t>(size.ws_col, kLeastColumns, kMostColumns);
}

}  // namespace apriltrack::app
