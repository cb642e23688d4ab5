#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/report/html_page.h"
#include "support/shared_data.h"

namespace apriltrack::test {

/// A line for each element of the page, `name|attributes|text`, as Python's own parser reads it. The page is
/// written into `folder`.
inline std::vector<std::string> elements_of(const HtmlPage& page,
                                            const std::filesystem::path& folder = temporary_folder()) {
  write_html_page(folder / "page.html", page);
  const auto listing = folder / "elements.txt";
  const std::string command =
      fmt::format("python3 '{}' '{}' '{}' > '{}'", source_path("tests/report/read_page.py").string(),
                  (folder / "page.html").string(), folder.string(), listing.string());
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::vector<std::string> lines;
  std::istringstream text(read_file(listing));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace apriltrack::test
