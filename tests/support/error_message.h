#pragma once

#include <gtest/gtest.h>

#include <string>

#include "apriltrack/base/error.h"

namespace apriltrack::test {

/// What the Error(kInvalidInput) says that function throws.
template <class Function>
std::string message_of(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace apriltrack::test
