#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "program.h"

namespace apriltrack::test {

/// What the folder of OneImage has: a pinhole of 160 x 120 pixels, and tag 0 of 0.16 m.
extern const char* const kGoodCamera;
extern const char* const kGoodMap;

/// A folder with a good camera, a good map, and one image without a tag; each test spoils one thing.
class OneImage : public ::testing::Test {
 protected:
  void SetUp() override;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static void write_image(const std::string& file, int width, int height);

  /// Good words for a command, with some options given other values, or added.
  static ProgramRun run_with(std::vector<std::string> words, const std::vector<std::string>& changes);
  ProgramRun track(const std::vector<std::string>& changes = {}) const;
  ProgramRun calibrate(const std::vector<std::string>& changes = {}) const;
  ProgramRun detect(const std::vector<std::string>& changes = {}) const;

  std::filesystem::path folder_;
};

/// `text` with its first `find` replaced; a failed expectation where it has none.
std::string replaced(std::string text, const std::string& find, const std::string& replace);

}  // namespace apriltrack::test
