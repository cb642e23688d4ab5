#pragma once

#include <stdexcept>
#include <string>

namespace apriltrack {

/// A function was called against its documented requirements: a mistake in the calling program.
class MisuseError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] void fail_check(const char* condition, const char* file, int line, const std::string& message);

}  // namespace apriltrack

/// States a requirement on the caller; a breach throws MisuseError with the place and the message.
#define APRILTRACK_CHECK(condition, message) \
  ((condition) ? static_cast<void>(0) : ::apriltrack::fail_check(#condition, __FILE__, __LINE__, (message)))
