#include "apriltrack/io/staged_files.h"

#include <gmock/gmock.h>

#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

namespace fs = std::filesystem;

class StagedFilesTest : public ::testing::Test {
 protected:
  fs::path folder_ = test::temporary_folder();

  std::size_t num_files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
};

TEST_F(StagedFilesTest, ReplaceTheirTargetsTogether) {
  write_file_atomically(folder_ / "a", "old");
  fs::permissions(folder_ / "a", fs::perms{0600});
  StagedFiles files;
  write_file_atomically(files.stage(folder_ / "a"), "new a");
  write_file_atomically(files.stage(folder_ / "b"), "new b");
  EXPECT_EQ(read_file(folder_ / "a"), "old");
  EXPECT_FALSE(fs::exists(folder_ / "b"));
  files.commit();
  EXPECT_EQ(read_file(folder_ / "a"), "new a");
  EXPECT_EQ(read_file(folder_ / "b"), "new b");
  EXPECT_EQ(fs::status(folder_ / "a").permissions(), fs::perms{0600});
  EXPECT_EQ(num_files(), 2U) << "nothing is left aside";
}

TEST_F(StagedFilesTest, LeaveNothingWhenTheyAreNotCommitted) {
  write_file_atomically(folder_ / "a", "old");
  {
    StagedFiles files;
    write_file_atomically(files.stage(folder_ / "a"), "new");
  }
  EXPECT_EQ(read_file(folder_ / "a"), "old");
  EXPECT_EQ(num_files(), 1U);
}

TEST_F(StagedFilesTest, KeepLinksAlsoThoseToNothingYet) {
  fs::create_symlink("later", folder_ / "link");
  StagedFiles files;
  write_file_atomically(files.stage(folder_ / "link"), "text");
  files.commit();
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(read_file(folder_ / "later"), "text");
}

TEST_F(StagedFilesTest, WriteDevicesDirectly) {
  StagedFiles files;
  EXPECT_EQ(files.stage("/dev/null"), "/dev/null");
  EXPECT_EQ(files.stage("/dev/null"), "/dev/null");
  EXPECT_EQ(files.stage("/dev/fd/0"), "/dev/fd/0");
}

TEST_F(StagedFilesTest, RefuseOneTargetTwice) {
  StagedFiles files;
  files.stage(folder_ / "a");
  fs::create_symlink("a", folder_ / "link");
  for (const char* name : {"a", "./a", "link"}) {
    try {
      files.stage(folder_ / name);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
      EXPECT_THAT(error.what(), ::testing::HasSubstr(name));
    }
  }
}

TEST_F(StagedFilesTest, NameTheTargetAsItWasGivenWhenItCannotBeWritten) {
  const auto fails_at = [](const fs::path& path) { throw io_error(path.string(), "no room"); };
  const auto fails_elsewhere = [](const fs::path&) { throw no_result("other", "no room"); };
  const fs::path name = folder_ / "." / "a";
  const auto complaint = [&](const auto& writer) -> std::string {
    try {
      StagedFiles().write(name, writer);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(complaint(fails_at), name.string() + ": no room");
  EXPECT_EQ(complaint(fails_elsewhere), "other: no room");
  EXPECT_EQ(complaint([](const fs::path& path) { write_file_atomically(path, "text"); }), "none");
  EXPECT_EQ(num_files(), 0U);
}

TEST_F(StagedFilesTest, AreOneFileByAllItsNames) {
  fs::create_directory(folder_ / "b");
  fs::create_directory_symlink("b", folder_ / "c");
  fs::create_symlink("../a", folder_ / "b" / "link");
  const fs::path file = fs::canonical(folder_) / "a";
  const std::vector<fs::path> names = {folder_ / "a", fs::relative(folder_ / "a"), folder_ / "b" / ".." / "a",
                                       folder_ / "b" / "link", folder_ / "c" / "link"};
  for (const bool is_there : {false, true}) {
    if (is_there) write_file_atomically(file, "text");
    for (const fs::path& name : names) EXPECT_EQ(written_file(name), file) << name;
  }
}

}  // namespace
}  // namespace apriltrack
