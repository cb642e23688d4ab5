#include "read_report.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {

/// The page's own policy binds what its scripts may ask for (read_page.py).
std::string without_scripts(std::string source) {
  for (auto at = source.find("<script>"); at != std::string::npos; at = source.find("<script>", at))
    source.erase(at, source.find("</script>", at) - at);
  return source;
}

std::string without_pictures(std::string source) {
  const std::string mark = "src=\"data:image/png;base64,";
  for (auto at = source.find(mark); at != std::string::npos; at = source.find(mark, at + mark.size())) {
    const auto bytes = at + mark.size();
    source.erase(bytes, source.find('"', bytes) - bytes);
  }
  return source;
}

}  // namespace

ReadReport::ReadReport(const std::filesystem::path& page) {
  const std::filesystem::path folder = page.string() + ".parts";
  std::filesystem::create_directories(folder);
  const std::string listing = folder / "elements.txt";
  const std::string command =
      fmt::format("python3 '{}' \"{}\" \"{}\" > \"{}\"", source_path("tests/report/read_page.py").string(),
                  page.string(), folder.string(), listing);
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::istringstream lines(read_text(listing));
  for (std::string line; std::getline(lines, line);) {
    const auto first = line.find('|'), second = line.find('|', first + 1);
    elements_.push_back(
        {line.substr(0, first), line.substr(first + 1, second - first - 1), line.substr(second + 1)});
  }
  source_ = without_scripts(without_pictures(read_text(page)));
}

std::vector<std::string> ReadReport::row(const std::string& name) const {
  const auto head = std::ranges::find_if(elements_, [&](const Element& element) {
    return element.name == "th" && element.attributes == "scope=row" && element.text == name;
  });
  EXPECT_NE(head, elements_.end()) << name;
  std::vector<std::string> cells;
  if (head == elements_.end()) return cells;
  for (auto cell = head + 1; cell != elements_.end() && cell->name == "td"; ++cell)
    cells.push_back(cell->text);
  return cells;
}

bool ReadReport::has_row(const std::string& name) const {
  return std::ranges::any_of(elements_, [&](const Element& element) {
    return element.name == "th" && element.attributes == "scope=row" && element.text == name;
  });
}

std::vector<std::string> ReadReport::texts(const std::string& element) const {
  std::vector<std::string> texts;
  for (const Element& one : elements_)
    if (one.name == element) texts.push_back(one.text);
  return texts;
}

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  for (const char* at = text.c_str(); *at != '\0';) {
    char* end = nullptr;
    if (std::isdigit(static_cast<unsigned char>(*at)) != 0) {
      numbers.push_back(std::strtod(at, &end));
      at = end;
    } else {
      ++at;
    }
  }
  return numbers;
}

}  // namespace apriltrack::test
