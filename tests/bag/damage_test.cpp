// Bags that are cut or have a flipped bit, anywhere.

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "damaged_bag.h"
#include "recording.h"

namespace apriltrack::test {
namespace {

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

}  // namespace
}  // namespace apriltrack::test
