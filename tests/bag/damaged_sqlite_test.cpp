#include <gmock/gmock.h>

#include <random>

#include "damaged_bag.h"
#include "recording.h"

namespace apriltrack::test {
namespace {

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
