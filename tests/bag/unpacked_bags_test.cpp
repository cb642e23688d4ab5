#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "recording.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

/// Files of this process that lie in a folder, with a name or without.
std::size_t num_open_in(const fs::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    count += fs::read_symlink(entry, gone).string().starts_with(folder.string() + "/");
  }
  return count;
}

class UnpackedBag : public testing::Test {
 protected:
  UnpackedBag() {
    fs::create_directories(scratch_);
    if (before_) saved_ = before_;
    setenv("TMPDIR", scratch_.c_str(), 1);
  }
  ~UnpackedBag() override {
    if (before_)
      setenv("TMPDIR", saved_.c_str(), 1);
    else
      unsetenv("TMPDIR");
  }

  /// How often it is unpacked while it is opened twice, one after the other.
  int count_unpackings() const {
    int count = 0;
    const LogSink log = [&](LogLevel, std::string_view text) {
      count += text.find("is unpacked into") != std::string_view::npos;
    };
    for (int i = 0; i < 2; ++i) EXPECT_EQ(read_all(*open_bag(bag_, log)).size(), expected_messages().size());
    return count;
  }

  const fs::path scratch_ = temporary_folder() / "scratch";
  const std::string bag_ = fixture("packed_file");

 private:
  const char* before_ = std::getenv("TMPDIR");
  std::string saved_;
};

TEST_F(UnpackedBag, GoesWithItsReader) {
  {
    const auto reader = open_bag(bag_);
    EXPECT_GT(num_open_in(scratch_), 0u);
  }
  EXPECT_EQ(num_open_in(scratch_), 0u);
  EXPECT_EQ(count_unpackings(), 2);
}

TEST_F(UnpackedBag, IsOneForAllItsReaders) {
  const auto reader = open_bag(bag_);
  EXPECT_EQ(count_unpackings(), 0);
  EXPECT_EQ(read_all(*reader).size(), expected_messages().size());
}

TEST_F(UnpackedBag, IsKeptWhereItIsAskedFor) {
  {
    const UnpackedBags kept;
    EXPECT_EQ(count_unpackings(), 1);
    EXPECT_GT(num_open_in(scratch_), 0u);
  }
  EXPECT_EQ(num_open_in(scratch_), 0u);
}

}  // namespace
}  // namespace apriltrack::test
