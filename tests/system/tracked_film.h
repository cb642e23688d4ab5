#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "program.h"

namespace apriltrack::test {

/// A shaken camera in a room: some frames are too blurred for detection; the fourth is no picture.
class TrackReport : public ::testing::Test {
 protected:
  /// Filmed and tracked once for all tests, by the first one that runs.
  void SetUp() override;

  static std::filesystem::path path(const std::string& name) { return folder_ / name; }

  static inline std::filesystem::path folder_;
  static inline ProgramRun run_;
};

}  // namespace apriltrack::test
