#pragma once

#include <gtest/gtest.h>

#include <string>

#include "apriltrack/base/error.h"

namespace apriltrack::test {

/// What the Error of that kind says that function throws.
template <class Function>
std::string message_of(const Function& function, ErrorKind kind = ErrorKind::kInvalidInput) {
  try {
    function();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace apriltrack::test
