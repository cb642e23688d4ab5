#include "apriltrack/base/check.h"

#include <fmt/format.h>

#include <string_view>

namespace apriltrack {

namespace {

/// Without the folders of the machine that compiled it: `file` is what __FILE__ says.
std::string_view file_name_of(std::string_view file) {
  return file.substr(file.find_last_of('/') + 1);  // npos + 1 is 0: the whole
}

}  // namespace

void fail_check(const char* condition, const char* file, int line, const std::string& message) {
  throw MisuseError(fmt::format("{} (required: {}; {}:{})", message, condition, file_name_of(file), line));
}

}  // namespace apriltrack
