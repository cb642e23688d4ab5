// Chunks of several packed streams, and headers that say a wrong size. The libraries pack.

#include <bzlib.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <lz4frame.h>
#include <zstd.h>

#include <stdexcept>

#include "bag_writers.h"
#include "recording.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string zstd_frame(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
  return packed;
}

std::string lz4_frame(const std::string& bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

std::string bz2_stream(const std::string& bytes) {
  std::string packed(bytes.size() + bytes.size() / 100 + 600, '\0');
  auto size = static_cast<unsigned int>(packed.size());
  if (BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(bytes.data()),
                               static_cast<unsigned int>(bytes.size()), 9, 0, 0) != BZ_OK)
    throw std::runtime_error("bz2 does not pack");
  packed.resize(size);
  return packed;
}

using Pack = std::string (*)(const std::string&);

/// Cut within a message.
std::vector<std::string> thirds(const std::string& bytes) {
  const std::size_t a = bytes.size() / 3, b = 2 * bytes.size() / 3;
  return {bytes.substr(0, a), bytes.substr(a, b - a), bytes.substr(b)};
}

std::vector<TestMessage> six_messages(Wire wire) {
  std::vector<TestMessage> messages;
  for (int i = 0; i < 6; ++i)
    messages.push_back({"/notes", "std_msgs/String", 100 + i,
                        MessageBytes(wire).text(fmt::format("{:0{}}", i, 300 + 40 * i)).done()});
  return messages;
}

struct Reading {
  std::vector<std::string> bytes;  ///< Of the good messages.
  std::size_t num_bad = 0;
  std::string damage;
};

Reading read(const fs::path& bag) {
  const auto reader = open_bag(bag);
  Reading reading;
  for (const Given& given : read_all(*reader)) {
    if (given.error.empty())
      reading.bytes.push_back(given.bytes);
    else
      ++reading.num_bad;
  }
  reading.damage = reader->damage();
  return reading;
}

std::vector<std::string> bytes_of(const std::vector<TestMessage>& messages) {
  std::vector<std::string> all;
  for (const TestMessage& one : messages) all.push_back(one.bytes);
  return all;
}

struct Packed {
  std::string name;
  Pack pack = nullptr;
  bool is_ros1 = false;
  std::string between = {};  ///< Of one stream and the next.
};

void PrintTo(const Packed& packed, std::ostream* out) {
  *out << packed.name << (packed.is_ros1 ? " in a ROS 1 bag" : " in MCAP");
}

fs::path write_bag(const Packed& packed, const ChunkForm& form) {
  const fs::path bag = temporary_folder() / "any";
  if (packed.is_ros1)
    write_ros1_bag(bag, six_messages(Wire::kRos1), form);
  else
    write_mcap(bag, Wire::kCdr, six_messages(Wire::kCdr), 6, form);
  return bag;
}

std::vector<std::string> bytes_of(const Packed& packed) {
  return bytes_of(six_messages(packed.is_ros1 ? Wire::kRos1 : Wire::kCdr));
}

class PackedChunks : public testing::TestWithParam<Packed> {};

// A skippable frame of three bytes may stand between frames of zstd and of LZ4.
const std::string kSkippable("\x53\x2A\x4D\x18\x03\0\0\0abc", 11);

INSTANTIATE_TEST_SUITE_P(Bags, PackedChunks,
                         testing::Values(Packed{"zstd", zstd_frame},
                                         Packed{"zstd", zstd_frame, false, kSkippable},
                                         Packed{"lz4", lz4_frame},
                                         Packed{"lz4", lz4_frame, false, kSkippable},
                                         Packed{"lz4", lz4_frame, true}, Packed{"bz2", bz2_stream, true}));

TEST_P(PackedChunks, GiveWhatIsInEveryStream) {
  const auto pack = [&](const std::string& chunk) {
    std::string all;
    for (const std::string& part : thirds(chunk))
      all += (all.empty() ? "" : GetParam().between) + GetParam().pack(part);
    return all;
  };
  for (const bool has_crc : {false, true}) {
    const Reading reading =
        read(write_bag(GetParam(), {.compression = GetParam().name, .pack = pack, .has_crc = has_crc}));
    EXPECT_EQ(reading.bytes, bytes_of(GetParam()));
    EXPECT_THAT(reading.damage, Not(HasSubstr("1 chunk")));
  }
}

/// What is there is whole by its own measure: only the header tells that a stream is missing.
TEST_P(PackedChunks, TellThatAStreamIsMissing) {
  const auto pack = [&](const std::string& chunk) { return GetParam().pack(thirds(chunk)[0]); };
  const Reading reading = read(write_bag(GetParam(), {.compression = GetParam().name, .pack = pack}));
  std::vector<std::string> first = bytes_of(GetParam());
  first.resize(2);
  EXPECT_EQ(reading.bytes, first);
  EXPECT_THAT(reading.damage,
              AllOf(HasSubstr("1 chunk can be read in part only"), HasSubstr("its header says")));
}

TEST_P(PackedChunks, TellThatTheirHeaderSaysAWrongSize) {
  for (const int size_error : {-5, 1000}) {
    const Reading reading = read(write_bag(
        GetParam(), {.compression = GetParam().name, .pack = GetParam().pack, .size_error = size_error}));
    EXPECT_EQ(reading.bytes, bytes_of(GetParam()));
    EXPECT_THAT(reading.damage, HasSubstr("its header says"));
  }
}

TEST(ChunkPackings, ThatAreNotReadAreNamed) {
  const ChunkForm form = {.compression = "brotli", .pack = [](const std::string& chunk) { return chunk; }};
  for (const bool is_ros1 : {false, true}) {
    const auto reader = open_bag(write_bag({.name = "brotli", .is_ros1 = is_ros1}, form));
    EXPECT_EQ(read_all(*reader).size(), 0u);
    EXPECT_THAT(reader->damage(),
                AllOf(HasSubstr("1 chunk cannot be read"), HasSubstr("packed by 'brotli'")));
  }
}

/// rosbag2 with `--compression-mode message`.
TEST(PackedMessages, AreUnpackedOneByOne) {
  const std::vector<TestMessage> plain = six_messages(Wire::kCdr);
  std::vector<TestMessage> packed = plain;
  for (TestMessage& one : packed) one.bytes = zstd_frame(one.bytes);
  const fs::path bag = temporary_folder() / "messages.mcap";
  write_mcap(bag, Wire::kCdr, packed, 6);
  EXPECT_EQ(read(bag).bytes, bytes_of(plain));
  packed[2].bytes.resize(packed[2].bytes.size() / 2);
  write_mcap(bag, Wire::kCdr, packed, 6);
  const Reading reading = read(bag);
  EXPECT_EQ(reading.bytes.size(), plain.size() - 1);
  EXPECT_EQ(reading.num_bad, 1u);
  EXPECT_THAT(reading.damage, HasSubstr("1 message cannot be read"));
}

TEST(ChunkSizes, AreComparedWhereNothingIsPacked) {
  const Packed plain;
  for (const int size_error : {-5, 1000}) {
    const Reading reading = read(write_bag(plain, {.size_error = size_error}));
    EXPECT_EQ(reading.bytes, bytes_of(plain));
    EXPECT_THAT(reading.damage, AllOf(HasSubstr("in part only"), HasSubstr("its header says")));
  }
}

TEST(ChunkSizes, AreWrongAndNoMoreWhereTheCrcIsRight) {
  const Packed plain;
  const Reading reading = read(write_bag(plain, {.has_crc = true, .size_error = 1000}));
  EXPECT_EQ(reading.bytes, bytes_of(plain));
  EXPECT_THAT(reading.damage, HasSubstr("1 chunk can be read in spite of a wrong header"));
}

TEST(ChunkSizes, TellOfALostChunkWhereTheCrcIsWrong) {
  const Packed packed = {"zstd", zstd_frame};
  const auto pack = [&](const std::string& chunk) { return zstd_frame(thirds(chunk)[0]); };
  const fs::path bag = write_bag(packed, {.compression = "zstd", .pack = pack, .has_crc = true});
  const auto reader = open_bag(bag);
  EXPECT_EQ(read_all(*reader).size(), 0u);
  EXPECT_THAT(reader->damage(), AllOf(HasSubstr("1 chunk cannot be read"), HasSubstr("its header says")));
}

}  // namespace
}  // namespace apriltrack::test
