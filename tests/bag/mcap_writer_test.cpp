// What McapWriter writes, as our reader sees it and, where it is installed, MCAP's own.
#include "apriltrack/bag/mcap_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/staged_files.h"
#include "recording.h"
#include "support/error_message.h"
#include "support/judge_output.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr int kMessages = 120;

struct Written {
  std::string topic;
  std::int64_t time_ns = 0;
  std::string bytes;
};

/// Messages of all byte values, the second topic's out of the order of time, and one that is empty.
std::vector<Written> messages() {
  std::vector<Written> all;
  for (int i = 0; i < kMessages; ++i) {
    std::string bytes;
    for (int k = 0; k < 7 * i % 300; ++k) bytes += static_cast<char>(i * k);
    const bool is_second = i % 3 == 2;
    all.push_back(
        {is_second ? "/second" : "/first", kStart_ns + (is_second ? 500 - i : i) * 1'000'000LL, bytes});
  }
  return all;
}

fs::path written(const std::vector<Written>& messages, ChunkPacking packing, std::size_t chunk_bytes = 2000) {
  const fs::path path = temporary_folder() / "out.mcap";
  StagedFiles files;
  McapWriter writer(files, path, {.packing = packing, .chunk_bytes = chunk_bytes});
  const auto first = writer.add({"/first", "raw", "made.Up", "jsonschema", "{}"});
  const auto second = writer.add({"/second", "raw", "made.Up", "jsonschema", "{}"});
  const auto silent = writer.add({"/silent", "raw", "made.Other", "jsonschema", "{\"type\": \"object\"}"});
  EXPECT_EQ((std::set<std::uint16_t>{first, second, silent}).size(), 3u);
  for (const Written& one : messages)
    writer.write(one.topic == "/first" ? first : second, {one.time_ns}, one.bytes);
  writer.close();
  files.commit();
  return path;
}

std::vector<std::string> keys_of(const std::vector<Given>& given) {
  std::vector<std::string> keys;
  for (const Given& one : given)
    keys.push_back(fmt::format("{} {} {}", one.log_time_ns, one.topic, one.bytes));
  return keys;
}

std::vector<std::string> sorted_keys(const std::vector<Written>& messages) {
  std::vector<Given> given;
  for (const Written& one : messages) given.push_back({one.topic, one.time_ns, one.bytes, ""});
  std::ranges::stable_sort(given, {}, &Given::log_time_ns);
  return keys_of(given);
}

TEST(McapWriter, WritesWhatOurReaderReads) {
  for (const ChunkPacking packing : {ChunkPacking::kNone, ChunkPacking::kLz4, ChunkPacking::kZstd}) {
    const auto reader = open_bag(written(messages(), packing));
    ASSERT_EQ(reader->topics().size(), 3u);
    EXPECT_EQ(reader->topics()[2].count, 0u);
    EXPECT_EQ(reader->topics()[0].name, "/first");
    EXPECT_EQ(reader->topics()[0].count, 80u);
    EXPECT_EQ(reader->topics()[1].count, 40u);
    EXPECT_EQ(reader->topics()[1].type, "made.Up");
    EXPECT_EQ(reader->topics()[1].encoding, "raw");
    EXPECT_EQ(reader->topics()[1].schema_encoding, "jsonschema");
    EXPECT_EQ(keys_of(read_all(*reader)), sorted_keys(messages()));
    EXPECT_EQ(reader->damage(), "");
  }
}

TEST(McapWriter, ItsChecksumsShowASingleFlippedBit) {
  const fs::path path = written(messages(), ChunkPacking::kNone);
  const std::string bytes = read_file(path);
  int num_shown = 0;
  for (std::size_t at = 300; at < bytes.size() / 2; at += 97) {
    std::string damaged = bytes;
    damaged[at] ^= 4;
    write_file_atomically(path, damaged);
    const auto reader = open_bag(path);
    const auto given = read_all(*reader);
    num_shown += !reader->damage().empty() || given.size() != kMessages;
  }
  // Bits of the message indices, a tenth of the file, are not under a CRC of a chunk.
  EXPECT_GT(num_shown, 80);
}

/// A file that is held open here: what is written to its path is written into it at once, with no other file
/// aside.
class OpenFile {
 public:
  explicit OpenFile(const fs::path& path)
      : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { ::close(descriptor_); }
  fs::path path() const { return "/dev/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

TEST(McapWriter, IsReadAsFarAsItCameWhereTheWriterStops) {
  const fs::path folder = temporary_folder();
  const OpenFile file(folder / "aside.mcap");
  {
    StagedFiles files;
    McapWriter writer(files, file.path(), {.chunk_bytes = 2000});
    const auto first = writer.add({"/first", "raw", "made.Up", "jsonschema", "{}"});
    for (const Written& one : messages()) writer.write(first, {one.time_ns}, one.bytes);
  }
  const auto reader = open_bag(folder / "aside.mcap");
  const auto given = read_all(*reader);
  EXPECT_GT(given.size(), 90u);
  EXPECT_LT(given.size(), 120u);
}

TEST(McapWriter, LeavesTheOldFileUntilTheNewOneIsComplete) {
  const fs::path path = temporary_folder() / "out.mcap";
  write_file_atomically(path, "old");
  StagedFiles files;
  {
    McapWriter writer(files, path);
    writer.write(writer.add({"/t", "raw", "a", "b", "c"}), {1}, "x");
    writer.close();
  }
  EXPECT_EQ(read_file(path), "old");
  files.commit();
  EXPECT_NE(read_file(path), "old");
  EXPECT_TRUE(is_bag(path));
}

TEST(McapWriter, TellsOfAFullDiskAndOfTimesThatItCannotHold) {
  StagedFiles files;
  EXPECT_THAT(message_of([&] { McapWriter writer(files, "/dev/full"); }, ErrorKind::kIo),
              HasSubstr("/dev/full: cannot be written: No space left"));
  const fs::path path = temporary_folder() / "out.mcap";
  EXPECT_THAT(message_of([&] { McapWriter writer(files, path / "in" / "none.mcap"); }, ErrorKind::kIo),
              HasSubstr("none.mcap: cannot be written"));
  McapWriter writer(files, path);
  const auto topic = writer.add({"/t", "raw", "a", "b", "c"});
  EXPECT_THAT(message_of([&] { writer.write(topic, {-5}, "x"); }),
              testing::AllOf(HasSubstr("out.mcap"), HasSubstr("-0.000000005 s")));
  EXPECT_THROW(writer.write(7, {5}, "x"), MisuseError);
}

TEST(McapWriter, HoldsNoMoreThanAChunk) {
  const fs::path folder = temporary_folder();
  StagedFiles files;
  const OpenFile file(folder / "out.mcap");
  McapWriter writer(files, file.path(), {.packing = ChunkPacking::kNone, .chunk_bytes = 10'000});
  const auto topic = writer.add({"/t", "raw", "a", "b", "c"});
  std::uint64_t given = 0;
  for (int i = 0; i < 500; ++i) {
    writer.write(topic, {i}, std::string(1000, 'x'));
    given += 1000;
    ASSERT_GE(fs::file_size(folder / "out.mcap") + 11'000, given);
  }
}

std::vector<std::string> lines_of_judge(const std::string& command) {
  std::istringstream stream(judge_output(command));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string base64_of(const std::string& bytes) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : alphabet[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

TEST(McapWriter, IsReadByMcapsOwnReaders) {
  APRILTRACK_NEED_JUDGE(node_judges({"@mcap/core"}));
  APRILTRACK_NEED_JUDGE(program_judge("zstd", "zstd"));
  APRILTRACK_NEED_JUDGE(program_judge("lz4", "lz4"));
  const auto read = [](const fs::path& path) {
    return lines_of_judge(
        fmt::format("{} '{}' '{}'", node(), source_path("tests/bag/read_mcap.mjs").string(), path.string()));
  };
  for (const ChunkPacking packing : {ChunkPacking::kNone, ChunkPacking::kLz4, ChunkPacking::kZstd}) {
    const std::vector<std::string> lines = read(written(messages(), packing));
    ASSERT_EQ(lines.size(), kMessages + 1u);
    std::map<std::string, int> sequence;
    for (std::size_t i = 0; i < kMessages; ++i) {
      const Written one = messages()[i];
      EXPECT_EQ(lines[i],
                fmt::format("{{\"topic\":\"{}\",\"time\":\"{}\",\"schema\":\"made.Up\",\"encoding\":"
                            "\"raw\",\"sequence\":{},\"base64\":\"{}\"}}",
                            one.topic, one.time_ns, sequence[one.topic]++, base64_of(one.bytes)));
    }
    EXPECT_THAT(lines.back(), HasSubstr("\"messageCount\":\"120\",\"schemaCount\":2,\"channelCount\":3"));
    EXPECT_THAT(lines.back(), HasSubstr("\"messageStartTime\":\"1700000000000000000\""));
    EXPECT_THAT(lines.back(), HasSubstr("[[1,\"80\"],[2,\"40\"],[3,\"0\"]]"));
    EXPECT_THAT(lines.back(),
                testing::ContainsRegex("\"crcs\":[1-9][0-9]"));  // of ten chunks, data and summary
  }
  EXPECT_EQ(read(written({}, ChunkPacking::kZstd)).size(), 1u);
}

}  // namespace
}  // namespace apriltrack::test
