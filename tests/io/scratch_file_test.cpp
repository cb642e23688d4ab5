#include "apriltrack/io/scratch_file.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/growing_file.h"
#include "apriltrack/io/staged_files.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {
namespace fs = std::filesystem;

TEST(ScratchFile, IsReachedByItsPathAndGoneInTheEnd) {
  const auto folder = test::temporary_folder();
  {
    const ScratchFile file(folder / "work");
    ASSERT_EQ(::write(file.descriptor(), "12345", 5), 5);
    EXPECT_EQ(read_file(file.path()), "12345");
    EXPECT_EQ(read_file(file.path()), "12345") << "any number of times";
  }
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST(ScratchFile, InAFolderThatIsMissingIsAnErrorAboutThatPlace) {
  const auto place = test::temporary_folder() / "missing" / "work";
  EXPECT_THAT(test::message_of([&] { ScratchFile file(place); }, ErrorKind::kIo),
              ::testing::StartsWith(place.string() + ": cannot be written: No such file"));
}

/// Runs `work` in a process that is killed (SIGKILL) when it says so by a byte through the pipe.
template <class Work>
void kill_in_the_middle_of(const Work& work) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    work([&] {
      const ssize_t told = ::write(ends[1], "x", 1);
      static_cast<void>(told);
      for (;;) ::pause();
    });
    ::_exit(1);
  }
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 1);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  ::close(ends[0]);
  ::close(ends[1]);
}

/// Whether the file system of these tests has files without a name, as ext4, XFS, Btrfs and tmpfs have.
bool has_nameless_files(const fs::path& folder) {
  return ScratchFile(folder / "try").path().string().starts_with("/proc/");
}

TEST(ScratchFile, OfAKilledProcessLeavesNothing) {
  const auto folder = test::temporary_folder();
  if (!has_nameless_files(folder)) GTEST_SKIP() << "this file system has no files without a name (O_TMPFILE)";
  kill_in_the_middle_of([&](const auto& wait_to_be_killed) {
    const ScratchFile file(folder / "work");
    const ssize_t written = ::write(file.descriptor(), "12345", 5);
    static_cast<void>(written);
    wait_to_be_killed();
  });
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST(AtomicFile, OfAKilledProcessLeavesTheOldOneAlone) {
  const auto folder = test::temporary_folder();
  if (!has_nameless_files(folder)) GTEST_SKIP() << "this file system has no files without a name (O_TMPFILE)";
  write_file_atomically(folder / "map.yaml", "old");
  kill_in_the_middle_of([&](const auto& wait_to_be_killed) {
    write_pieces_atomically(folder / "map.yaml", [&](const auto& write) {
      write("half of the n");
      wait_to_be_killed();
    });
  });
  EXPECT_EQ(read_file(folder / "map.yaml"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST(GrowingFile, OfAKilledProcessLeavesTheOldOneAlone) {
  const auto folder = test::temporary_folder();
  if (!has_nameless_files(folder)) GTEST_SKIP() << "this file system has no files without a name (O_TMPFILE)";
  write_file_atomically(folder / "run.mcap", "old");
  kill_in_the_middle_of([&](const auto& wait_to_be_killed) {
    StagedFiles files;
    GrowingFile file(files, folder / "run.mcap");
    file.write("half of the n");
    wait_to_be_killed();
  });
  EXPECT_EQ(read_file(folder / "run.mcap"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST(GrowingFile, TakesTheOldOnesPlaceWhenItIsCommitted) {
  const auto folder = test::temporary_folder();
  write_file_atomically(folder / "run.mcap", "old");
  StagedFiles files;
  GrowingFile file(files, folder / "run.mcap");
  file.write("12");
  file.write("345");
  file.close();
  EXPECT_EQ(read_file(folder / "run.mcap"), "old");
  files.commit();
  EXPECT_EQ(read_file(folder / "run.mcap"), "12345");
  EXPECT_EQ(file.size(), 5U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace apriltrack
