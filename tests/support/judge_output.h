#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace apriltrack::test {

/// stdout of another project's reader, run by a shell; a failed expectation where it fails.
inline std::string judge_output(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  char buffer[4096];
  for (std::size_t size = 0; (size = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    text.append(buffer, size);
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return text;
}

}  // namespace apriltrack::test
