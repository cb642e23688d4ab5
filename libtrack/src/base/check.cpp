#include "apriltrack/base/check.h"

#include <fmt/format.h>

namespace apriltrack {

void fail_check(const char* condition, const char* file, int line, const std::string& message) {
  throw MisuseError(fmt::format("{} (required: {}; {}:{})", message, condition, file, line));
}

}  // namespace apriltrack
