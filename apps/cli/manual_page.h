#pragma once

#include <string>
#include <vector>

#include "option_table.h"

namespace apriltrack::app {

/// A page for man(1) in roff, section 1.
std::string manual_page(const CommandTable& command);

struct ManualFile {
  std::string name;  ///< "apriltrack-map-convert.1"
  std::string text;
};

/// The pages of a command and of all below it.
std::vector<ManualFile> manual_files(const CommandTable& command);

}  // namespace apriltrack::app
