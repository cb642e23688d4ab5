#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/base/error.h"
#include "recording.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

/// What another reader says of a chunk (make_fixtures.py): its bytes, and when its messages were logged.
struct KnownChunk {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::vector<std::int64_t> log_times_ns;
};

std::vector<KnownChunk> known_chunks(const std::string& name) {
  std::vector<KnownChunk> chunks;
  std::ifstream file(fixture("chunks.csv"));
  std::string line;
  while (std::getline(file, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    std::string of;
    KnownChunk chunk;
    words >> of >> chunk.begin >> chunk.end;
    if (of != name) continue;
    for (std::int64_t time_ns = 0; words >> time_ns;) chunk.log_times_ns.push_back(time_ns + kFirstStamp_ns);
    chunks.push_back(chunk);
  }
  return chunks;
}

/// Of formats without chunks, each message is its own: where its payload is in the file, and room for the
/// record before it.
std::vector<KnownChunk> known_messages(const std::string& bytes) {
  constexpr std::size_t kMostBefore = 120;
  std::vector<KnownChunk> chunks;
  for (const Expected& message : expected_messages()) {
    if (message.topic == "/camera/camera_info") continue;  // two have the same payload
    const std::size_t at = bytes.find(message.payload);
    EXPECT_NE(at, std::string::npos) << message.topic;
    chunks.push_back(
        {at - std::min(at, kMostBefore), at + message.payload.size() + 1, {message.log_time_ns}});
  }
  return chunks;
}

/// What a reader makes of damaged bytes.
struct Outcome {
  bool is_refused = false;
  std::vector<Given> given;
  std::string damage;
};

Outcome read_damaged(const std::string& bytes) {
  const std::string path = (temporary_folder() / "damaged").string();
  write_bytes(path, bytes);
  Outcome outcome;
  try {
    const auto reader = open_bag(path);
    outcome.given = read_all(*reader);
    outcome.damage = reader->damage();
  } catch (const Error& error) {
    outcome.is_refused = true;
    outcome.damage = error.what();
  }
  return outcome;
}

std::map<std::int64_t, Expected> expected_by_time() {
  std::map<std::int64_t, Expected> all;
  for (const Expected& one : expected_messages()) all[one.log_time_ns] = one;
  return all;
}

/// Log times of the messages that were given as they were recorded, each once. Their topics' names are not
/// looked at, which no checksum of ROS 1 guards; no two messages were logged at one time.
std::set<std::int64_t> right_ones(const Outcome& outcome) {
  static const auto all = expected_by_time();
  std::set<std::int64_t> times;
  for (const Given& given : outcome.given) {
    const auto expected = all.find(given.log_time_ns);
    if (expected == all.end() || !has_payload(given, expected->second)) continue;
    EXPECT_TRUE(times.insert(given.log_time_ns).second) << "given twice: " << given.log_time_ns;
  }
  return times;
}

std::size_t num_wrong(const Outcome& outcome) {
  const auto num_bad =
      std::ranges::count_if(outcome.given, [](const Given& one) { return !one.error.empty(); });
  return outcome.given.size() - right_ones(outcome).size() - static_cast<std::size_t>(num_bad);
}

/// Messages of the chunks that `is_whole` holds of must all be given.
template <class IsWhole>
void expect_whole_chunks(const std::vector<KnownChunk>& chunks, const Outcome& outcome,
                         const IsWhole& is_whole, std::size_t& num_checked) {
  const std::set<std::int64_t> right = right_ones(outcome);
  for (const KnownChunk& chunk : chunks) {
    if (!is_whole(chunk)) continue;
    for (const std::int64_t time_ns : chunk.log_times_ns) {
      EXPECT_TRUE(right.contains(time_ns))
          << "lost: " << time_ns << " of the chunk at " << chunk.begin << "; told: " << outcome.damage;
      ++num_checked;
    }
  }
}

struct Damageable {
  std::string name;
  std::size_t magic_bytes = 0;
  bool has_checksums = true;
};

void PrintTo(const Damageable& fixture, std::ostream* out) {
  *out << fixture.name;
}

class EveryChunkedFormat : public testing::TestWithParam<Damageable> {};

INSTANTIATE_TEST_SUITE_P(Bags, EveryChunkedFormat,
                         testing::Values(Damageable{"plain.bag", 13, false}, Damageable{"bz2.bag", 13},
                                         Damageable{"lz4.bag", 13}, Damageable{"plain.mcap", 8},
                                         Damageable{"lz4.mcap", 8}, Damageable{"zstd.mcap", 8},
                                         Damageable{"ros1_zstd.mcap", 8}));

/// Cut at 20 random places, each file gives the chunks before the cut, nothing wrong, and word of what is
/// lost.
void expect_whole_chunks_of_cut_files(const std::string& whole, const std::vector<KnownChunk>& chunks,
                                      std::uint32_t seed) {
  std::mt19937 random(seed);
  std::size_t num_checked = 0;
  for (int i = 0; i < 20; ++i) {
    const std::size_t size = random() % whole.size();
    SCOPED_TRACE(size);
    const Outcome outcome = read_damaged(whole.substr(0, size));
    const auto is_whole = [&](const KnownChunk& chunk) { return chunk.end <= size; };
    expect_whole_chunks(chunks, outcome, is_whole, num_checked);
    EXPECT_EQ(num_wrong(outcome), 0u);
    EXPECT_NE(outcome.damage, "");
  }
  EXPECT_GT(num_checked, 200u);
}

TEST_P(EveryChunkedFormat, GivesEveryWholeChunkOfACutFile) {
  const std::vector<KnownChunk> chunks = known_chunks(GetParam().name);
  ASSERT_GE(chunks.size(), 4u);
  expect_whole_chunks_of_cut_files(read_bytes(fixture(GetParam().name)), chunks, 20);
}

TEST_P(EveryChunkedFormat, LosesNoOtherChunkByAFlippedBit) {
  const std::string whole = read_bytes(fixture(GetParam().name));
  const std::vector<KnownChunk> chunks = known_chunks(GetParam().name);
  std::mt19937 random(100);
  std::size_t num_checked = 0, num_lost = 0;
  for (int i = 0; i < 100; ++i) {
    const std::size_t at = GetParam().magic_bytes + random() % (whole.size() - GetParam().magic_bytes);
    const int bit = static_cast<int>(random() % 8);
    SCOPED_TRACE(testing::Message() << "byte " << at << " bit " << bit);
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
    const Outcome outcome = read_damaged(bytes);
    const auto is_whole = [&](const KnownChunk& chunk) { return at < chunk.begin || at >= chunk.end; };
    expect_whole_chunks(chunks, outcome, is_whole, num_checked);
    EXPECT_TRUE(num_wrong(outcome) == 0 || !GetParam().has_checksums);
    const bool is_something_lost = right_ones(outcome).size() < expected_messages().size();
    num_lost += is_something_lost;
    EXPECT_TRUE(!is_something_lost || !GetParam().has_checksums || !outcome.damage.empty());
  }
  EXPECT_GT(num_checked, 4000u);
  EXPECT_GT(num_lost, 5u);
}

class EveryUnchunkedFormat : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Bags, EveryUnchunkedFormat, testing::Values("without_chunks.mcap"));

TEST_P(EveryUnchunkedFormat, GivesEveryWholeMessageOfACutFile) {
  const std::string whole = read_bytes(fixture(GetParam()));
  expect_whole_chunks_of_cut_files(whole, known_messages(whole), 21);
}

TEST_P(EveryUnchunkedFormat, LosesNoOtherMessageByAFlippedBit) {
  const std::string whole = read_bytes(fixture(GetParam()));
  const std::vector<KnownChunk> messages = known_messages(whole);
  std::mt19937 random(101);
  std::size_t num_checked = 0;
  for (int i = 0; i < 100; ++i) {
    // In a message: topics are told between the first of them.
    const KnownChunk& hit = messages[random() % messages.size()];
    const std::size_t at = hit.end - 1 - random() % 24;
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    const Outcome outcome = read_damaged(bytes);
    SCOPED_TRACE(at);
    const auto is_whole = [&](const KnownChunk& one) { return at < one.begin || at >= one.end; };
    expect_whole_chunks(messages, outcome, is_whole, num_checked);
  }
  EXPECT_GT(num_checked, 4000u);
}

/// Cut, or with a flipped bit: both at once in one chunk leave nothing to check its beginning by.
TEST(DamagedBag, SurvivesAnyDamageWithoutAnIndex) {
  const std::string whole = read_bytes(fixture("without_index.mcap"));
  std::mt19937 random(102);
  std::size_t num_right = 0;
  for (int i = 0; i < 200; ++i) {
    std::string bytes = whole;
    const std::size_t at = 8 + random() % (whole.size() - 8);
    if (i % 2 == 0)
      bytes.resize(at);
    else
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    const Outcome outcome = read_damaged(bytes);
    EXPECT_EQ(num_wrong(outcome), 0u);
    num_right += right_ones(outcome).size();
  }
  EXPECT_GT(num_right, 200u * 20u);
}

TEST(DamagedBag, TellsOfItsCutInWords) {
  const std::string whole = read_bytes(fixture("zstd.mcap"));
  const std::vector<KnownChunk> chunks = known_chunks("zstd.mcap");
  const std::size_t size = (chunks.back().begin + chunks.back().end) / 2;
  const Outcome outcome = read_damaged(whole.substr(0, size));
  EXPECT_THAT(outcome.damage,
              testing::HasSubstr("ends within the record at byte " + std::to_string(chunks.back().begin)));
}

TEST(DamagedBag, TellsOfALostChunk) {
  std::string bytes = read_bytes(fixture("plain.mcap"));
  const KnownChunk chunk = known_chunks("plain.mcap")[2];
  bytes[chunk.end - 1] = static_cast<char>(bytes[chunk.end - 1] ^ 1);
  const Outcome outcome = read_damaged(bytes);
  EXPECT_THAT(outcome.damage, testing::HasSubstr("1 chunk cannot be read (the first, at byte " +
                                                 std::to_string(chunk.begin) + ": its CRC-32"));
  const auto num_errors =
      std::ranges::count_if(outcome.given, [](const Given& one) { return !one.error.empty(); });
  EXPECT_EQ(static_cast<std::size_t>(num_errors), chunk.log_times_ns.size());
}

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

/// SQLite's pages, of 1024 bytes here: damage to one costs the messages of that one.
TEST(DamagedSqlite, LosesNoOtherPageByAFlippedBit) {
  constexpr std::size_t kPage = 1024;
  const std::string whole = read_bytes(fixture("plain.db3"));
  const std::vector<KnownChunk> messages = known_messages(whole);
  std::set<std::size_t> pages;
  for (const KnownChunk& one : messages) pages.insert((one.end - 2) / kPage);
  ASSERT_GE(pages.size(), 3u);
  std::mt19937 random(103);
  std::size_t num_checked = 0;
  for (int i = 0; i < 100; ++i) {
    const std::size_t at = random() % whole.size();
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    const Outcome outcome = read_damaged(bytes);
    SCOPED_TRACE(at);
    if (!pages.contains(at / kPage)) continue;  // the list of tables, or of pages
    const auto is_whole = [&](const KnownChunk& one) { return (one.end - 2) / kPage != at / kPage; };
    expect_whole_chunks(messages, outcome, is_whole, num_checked);
  }
  EXPECT_GT(num_checked, 500u);
}

TEST(DamagedSqlite, GivesTheWholePagesOfACutFile) {
  constexpr std::size_t kPage = 1024;
  const std::string whole = read_bytes(fixture("plain.db3"));
  const std::vector<KnownChunk> messages = known_messages(whole);
  std::mt19937 random(22);
  std::size_t num_checked = 0;
  for (int i = 0; i < 20; ++i) {
    const std::size_t size =
        whole.size() - 1 - random() % (5 * kPage);  // tables and their roots stand before
    SCOPED_TRACE(size);
    const Outcome outcome = read_damaged(whole.substr(0, size));
    EXPECT_NE(outcome.damage, "");
    const auto is_whole = [&](const KnownChunk& one) { return one.end <= size / kPage * kPage; };
    expect_whole_chunks(messages, outcome, is_whole, num_checked);
    EXPECT_EQ(num_wrong(outcome), 0u);
  }
  EXPECT_GT(num_checked, 100u);
}

}  // namespace
}  // namespace apriltrack::test
