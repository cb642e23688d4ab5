// SQLite files whose recorder was killed, as SQLite itself leaves them: copied while it is recording.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <map>

#include "bag_writers.h"
#include "recording.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TestMessage message(int i) {
  // Of three pages, the last of them half full.
  return {"/notes", "std_msgs/String", 1000 + i,
          MessageBytes(Wire::kCdr).text(fmt::format("{:0{}}", i, 10'000)).done()};
}

class KilledRecorder : public testing::Test {
 protected:
  /// In a folder that is emptied before.
  fs::path copy(const std::vector<std::string>& endings) const {
    const fs::path folder = folder_ / "killed";
    fs::remove_all(folder);
    fs::create_directories(folder);
    for (const std::string& ending : endings)
      fs::copy(recorded_.string() + ending, folder / ("bag.db3" + ending));
    return folder / "bag.db3";
  }

  const fs::path folder_ = temporary_folder();
  const fs::path recorded_ = folder_ / "bag.db3";
};

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    files[entry.path().filename()] = entry.is_directory() ? "a folder" : read_bytes(entry.path());
  return files;
}

struct Reading {
  std::size_t num_right = 0;
  std::size_t num_wrong = 0;
  std::string damage;
};

/// Looks, too, that nothing comes up beside the file, nor changes, from when it is opened on.
Reading read(const fs::path& bag) {
  const auto before = contents(bag.parent_path());
  Reading reading;
  {
    const auto reader = open_bag(bag);
    for (const Given& given : read_all(*reader)) {
      const int i = static_cast<int>(given.log_time_ns - 1000);
      const bool is_right = given.error.empty() && given.bytes == message(i).bytes;
      ++(is_right ? reading.num_right : reading.num_wrong);
    }
    reading.damage = reader->damage();
    EXPECT_EQ(contents(bag.parent_path()), before);
  }
  EXPECT_EQ(contents(bag.parent_path()), before);
  return reading;
}

TEST_F(KilledRecorder, LeavesAWriteAheadLogThatIsRead) {
  Db3Recorder recorder(recorded_, "PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0;");
  for (int i = 0; i < 5; ++i) recorder.add(message(i));
  recorder.run("PRAGMA wal_checkpoint");
  for (int i = 5; i < 12; ++i) recorder.add(message(i));
  const std::vector<std::vector<std::string>> leftovers = {{"", "-wal"}, {"", "-wal", "-shm"}};
  for (const auto& endings : leftovers) {
    const Reading reading = read(copy(endings));
    EXPECT_EQ(reading.num_right, 12u);
    EXPECT_EQ(reading.num_wrong, 0u);
    EXPECT_EQ(reading.damage, "");
  }
}

TEST_F(KilledRecorder, LeavesALogBesideTheFileThatALinkLeadsTo) {
  Db3Recorder recorder(recorded_, "PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0;");
  for (int i = 0; i < 5; ++i) recorder.add(message(i));
  const fs::path link = folder_ / "links/any.db3";
  fs::create_directories(link.parent_path());
  fs::create_symlink(copy({"", "-wal"}), link);
  EXPECT_EQ(read(link).num_right, 5u);
}

/// As a user's who may not write there. (To the system's administrator nothing is forbidden.)
TEST_F(KilledRecorder, IsReadWhereNothingMayBeWritten) {
  Db3Recorder recorder(recorded_, "PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0;");
  for (int i = 0; i < 5; ++i) recorder.add(message(i));
  const fs::path bag = copy({"", "-wal"});
  fs::permissions(bag, fs::perms::owner_read);
  fs::permissions(bag.string() + "-wal", fs::perms::owner_read);
  fs::permissions(bag.parent_path(), fs::perms::owner_read | fs::perms::owner_exec);
  const Reading reading = read(bag);
  fs::permissions(bag.parent_path(), fs::perms::owner_all);
  EXPECT_EQ(reading.num_right, 5u);
  EXPECT_EQ(reading.damage, "");
}

TEST_F(KilledRecorder, LeavesALogThatCannotBeRead) {
  Db3Recorder recorder(recorded_, "PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0;");
  for (int i = 0; i < 5; ++i) recorder.add(message(i));
  recorder.run("PRAGMA wal_checkpoint");
  for (int i = 5; i < 12; ++i) recorder.add(message(i));
  const fs::path bag = copy({""});
  fs::create_directories(bag.string() + "-wal");
  const Reading reading = read(bag);
  EXPECT_EQ(reading.num_right, 5u);
  EXPECT_THAT(reading.damage, AllOf(HasSubstr("what is in bag.db3-wal is missing"), HasSubstr("a folder")));
}

TEST_F(KilledRecorder, LeavesATransactionThatItDidNotFinish) {
  Db3Recorder recorder(recorded_, "PRAGMA journal_mode = DELETE; PRAGMA cache_size = 10;");
  recorder.run("BEGIN");
  for (int i = 0; i < 30; ++i) recorder.add(message(i));
  recorder.run("COMMIT; BEGIN");
  for (int i = 30; i < 60; ++i) recorder.add(message(i));
  const fs::path bag = copy({"", "-journal"});
  ASSERT_GT(fs::file_size(bag), 40u * 10'000u) << "SQLite wrote nothing of the transaction";
  const Reading reading = read(bag);
  EXPECT_GE(reading.num_right, 30u);
  EXPECT_THAT(reading.damage,
              HasSubstr("did not finish the last transaction (bag.db3-journal lies beside it)"));
}

/// With a journal that is kept for the next one.
TEST_F(KilledRecorder, IsNotMistakenForOneThatEnded) {
  Db3Recorder recorder(recorded_, "PRAGMA journal_mode = PERSIST");
  for (int i = 0; i < 5; ++i) recorder.add(message(i));
  const Reading reading = read(copy({"", "-journal"}));
  EXPECT_EQ(reading.num_right, 5u);
  EXPECT_EQ(reading.damage, "");
}

}  // namespace
}  // namespace apriltrack::test
