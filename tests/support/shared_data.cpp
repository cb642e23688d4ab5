#include "support/shared_data.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace apriltrack::test {
namespace fs = std::filesystem;
namespace {

/// Removed at the end of the program unless a test failed: then it stays, to be looked at.
class TemporaryRoot {
 public:
  TemporaryRoot() : path_(fs::temp_directory_path() / ("apriltrack-test-" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~TemporaryRoot() {
    std::error_code ignored;
    if (!::testing::UnitTest::GetInstance()->Failed()) fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

std::optional<fs::path> shared_path(const std::string& name) {
  const char* root = std::getenv("APRILTRACK_SHARED");
  const fs::path path =
      (root ? fs::path(root) : fs::path(APRILTRACK_SOURCE_DIR).parent_path() / "shared") / name;
  if (!fs::exists(path)) return std::nullopt;
  return path;
}

fs::path source_path(const std::string& name) {
  return fs::path(APRILTRACK_SOURCE_DIR) / name;
}

fs::path temporary_folder() {
  static const TemporaryRoot root;
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test->test_suite_name()) + "." + test->name();
  for (char& c : name) {
    if (c == '/') c = '_';
  }
  const fs::path folder = root.path() / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

}  // namespace apriltrack::test
