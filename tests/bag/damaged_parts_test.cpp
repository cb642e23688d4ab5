// Bags whose index, sizes or footer are wrong.

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "apriltrack/bag/bag_reader.h"
#include "damaged_bag.h"
#include "recording.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

/// What a recorder of ROS 1 leaves when it is killed (.bag.active): the header knows of no index, and the
/// last chunk's sizes are still zero, with what there is of it behind.
std::string as_active(std::string bytes, const KnownChunk& last, std::size_t size) {
  bytes.resize(size);
  const auto zero = [&](std::size_t at, std::size_t count) {
    bytes.replace(at, count, std::string(count, '\0'));
  };
  zero(bytes.find("index_pos=") + 10, 8);
  zero(bytes.find("chunk_count=") + 12, 4);
  zero(bytes.find("conn_count=") + 11, 4);
  // Its fields are op, compression and size; the data's length follows them.
  const std::size_t of_size = bytes.find("size=", last.begin) + 5;
  zero(of_size, 8);
  return bytes;
}

TEST(DamagedBag, ReadsWhatAKilledRecorderLeft) {
  for (const char* name : {"plain.bag", "lz4.bag"}) {
    const std::string whole = read_bytes(fixture(name));
    const std::vector<KnownChunk> chunks = known_chunks(name);
    const KnownChunk& last = chunks[4];
    // All of the chunk's data, but neither its index nor what follows.
    const Outcome outcome = read_damaged(as_active(whole, last, last.end));
    std::size_t num_checked = 0;
    expect_whole_chunks(
        {chunks.begin(), chunks.begin() + 5}, outcome, [](const KnownChunk&) { return true; }, num_checked);
    EXPECT_GT(num_checked, 20u) << name;
    EXPECT_EQ(num_wrong(outcome), 0u);
    EXPECT_THAT(outcome.damage, testing::HasSubstr("no whole index"));
  }
}

/// The index records of a ROS 1 bag as python3-rosbag writes them: fields op, conn, ver, count, then entries
/// of 12 bytes.
struct Ros1IndexRecord {
  std::size_t conn = 0;  ///< Where the numbers are in the file.
  std::size_t count = 0;
  std::size_t data_size = 0;
  std::size_t entries = 0;
};

std::vector<Ros1IndexRecord> index_records(const std::string& bytes) {
  std::vector<Ros1IndexRecord> records;
  for (std::size_t at = bytes.find("op=\x04"); at != std::string::npos; at = bytes.find("op=\x04", at + 1))
    records.push_back({at + 13, at + 39, at + 43, at + 47});
  return records;
}

/// Its number alone is another connection's: told by the counts at the end of the file.
TEST(DamagedBag, SeesThatAnIndexIsOfAnotherTopic) {
  std::string bytes = read_bytes(fixture("plain.bag"));
  const auto records = index_records(bytes);
  const auto gyro = std::ranges::find_if(records, [&](const auto& one) { return bytes[one.count] > 4; });
  ASSERT_NE(gyro, records.end());
  for (char other = 0; other < 4; ++other) {
    std::string damaged = bytes;
    damaged[gyro->conn] = other;
    const std::string path = (temporary_folder() / "damaged").string();
    write_bytes(path, damaged);
    EXPECT_EQ(read_all(*open_bag(path), {"/gyro"}).size(), 40u) << int{other};
  }
}

/// An entry is missing, and nothing at the end of the file counts the messages.
TEST(DamagedBag, SeesThatAnIndexLacksAMessage) {
  std::string bytes = read_bytes(fixture("plain.bag"));
  const auto records = index_records(bytes);
  // Not of the first such chunk, which is looked into anyway: it tells of the topics.
  const auto last =
      std::find_if(records.rbegin(), records.rend(), [&](const auto& one) { return bytes[one.count] > 4; });
  ASSERT_NE(last, records.rend());
  const std::size_t end =
      records.back().entries + 12 * static_cast<unsigned char>(bytes[records.back().count]);
  bytes.resize(end);
  const int count = static_cast<unsigned char>(bytes[last->count]);
  bytes[last->count] = static_cast<char>(count - 1);
  bytes[last->data_size] = static_cast<char>(12 * (count - 1));
  bytes.erase(last->entries + 12 * static_cast<std::size_t>(count - 1), 12);
  const std::string path = (temporary_folder() / "damaged").string();
  write_bytes(path, bytes);
  EXPECT_EQ(read_all(*open_bag(path), {"/gyro"}).size(), 40u);
}

/// A header may claim any size: what is not there takes no memory.
TEST(DamagedBag, BelievesNoSizeWithoutBytes) {
  std::string bytes = read_bytes(fixture("zstd.mcap"));
  const KnownChunk chunk = known_chunks("zstd.mcap")[1];
  // unpacked_size stands behind opcode, length and two times.
  for (std::size_t i = 0; i < 8; ++i) bytes[chunk.begin + 9 + 16 + i] = '\x7f';
  const Outcome outcome = read_damaged(bytes);
  EXPECT_EQ(right_ones(outcome).size(), expected_messages().size());
  // Its CRC is right.
  EXPECT_THAT(outcome.damage, testing::HasSubstr("1 chunk can be read in spite of a wrong header"));
}

/// A large file, most of it a hole, whose footer says that the summary begins at the file's beginning.
TEST(DamagedBag, BringsNoLargeFileIntoMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more memory than the test allows";
#endif
  constexpr std::size_t kLarge = std::size_t{6} << 30;
  constexpr std::size_t kMost = std::size_t{1} << 30;
  const fs::path path = temporary_folder() / "large.mcap";
  const std::string whole = read_bytes(fixture("zstd.mcap"));
  constexpr std::size_t kTail = 37;  // footer and magic
  std::string tail = whole.substr(whole.size() - kTail);
  tail.replace(9, 8, std::string("\x08\0\0\0\0\0\0\0", 8));
  write_bytes(path.string(), whole.substr(0, whole.size() - kTail));
  fs::resize_file(path, kLarge);
  std::ofstream(path, std::ios::binary | std::ios::app) << tail;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit limit{static_cast<rlim_t>(kMost), before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &limit), 0);
  std::set<std::int64_t> right;
  try {
    Outcome outcome;
    outcome.given = read_all(*open_bag(path));
    right = right_ones(outcome);
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
  setrlimit(RLIMIT_AS, &before);
  EXPECT_EQ(right.size(), expected_messages().size());
}

}  // namespace
}  // namespace apriltrack::test
