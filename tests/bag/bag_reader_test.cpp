#include "apriltrack/bag/bag_reader.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <map>

#include "bag_writers.h"
#include "recording.h"
#include "support/error_message.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;

struct Fixture {
  std::string name;
  bool is_ros1 = false;
};

void PrintTo(const Fixture& fixture, std::ostream* out) {
  *out << fixture.name;
}

class EveryFormat : public testing::TestWithParam<Fixture> {};

INSTANTIATE_TEST_SUITE_P(Bags, EveryFormat,
                         testing::Values(Fixture{"plain.bag", true}, Fixture{"bz2.bag", true},
                                         Fixture{"lz4.bag", true}, Fixture{"plain.mcap"}, Fixture{"lz4.mcap"},
                                         Fixture{"zstd.mcap"}, Fixture{"ros1_zstd.mcap", true},
                                         Fixture{"without_chunks.mcap"}, Fixture{"without_index.mcap"},
                                         Fixture{"plain.db3"}, Fixture{"split"}, Fixture{"packed_messages"},
                                         Fixture{"packed_file"}));

TEST_P(EveryFormat, IsSeenByItsBytes) {
  EXPECT_TRUE(is_bag(fixture(GetParam().name)));
}

TEST_P(EveryFormat, ListsItsTopics) {
  const auto reader = open_bag(fixture(GetParam().name));
  std::map<std::string, BagTopic> topics;
  for (const BagTopic& topic : reader->topics()) topics[topic.name] = topic;
  ASSERT_EQ(topics.size(), 4u);
  EXPECT_EQ(reader->topics().size(), 4u);
  const std::string package = GetParam().is_ros1 ? "sensor_msgs/" : "sensor_msgs/msg/";
  EXPECT_EQ(topics["/camera/image_raw"].type, package + "Image");
  EXPECT_EQ(topics["/camera/camera_info"].type, package + "CameraInfo");
  EXPECT_EQ(topics["/camera/image_raw"].encoding, GetParam().is_ros1 ? "ros1" : "cdr");
  EXPECT_EQ(topics["/camera/image_raw"].count, 8u);
  EXPECT_EQ(topics["/camera/camera_info"].count, 2u);
  EXPECT_EQ(topics["/notes"].count, 3u);
  EXPECT_EQ(topics["/gyro"].count, 40u);
  EXPECT_EQ(reader->damage(), "");
}

TEST_P(EveryFormat, GivesAllMessagesInTheOrderOfLogTime) {
  const auto reader = open_bag(fixture(GetParam().name));
  const std::vector<Given> given = read_all(*reader);
  const std::vector<Expected> expected = expected_messages();
  ASSERT_EQ(given.size(), expected.size());
  EXPECT_EQ(reader->num_messages(), expected.size());
  for (std::size_t i = 0; i < given.size(); ++i)
    EXPECT_TRUE(is_same(given[i], expected[i])) << i << ": " << given[i].topic << " " << given[i].error;
  EXPECT_EQ(reader->damage(), "");
}

TEST_P(EveryFormat, GivesTheTopicsChosenFromTheBeginning) {
  const auto reader = open_bag(fixture(GetParam().name));
  EXPECT_FALSE(reader->next());
  read_all(*reader, {"/gyro"});
  const std::vector<Given> given = read_all(*reader, {"/notes", "/camera/image_raw"});
  std::size_t i = 0;
  for (const Expected& expected : expected_messages()) {
    if (expected.topic != "/notes" && expected.topic != "/camera/image_raw") continue;
    ASSERT_LT(i, given.size());
    EXPECT_TRUE(is_same(given[i++], expected));
  }
  EXPECT_EQ(i, given.size());
}

TEST_P(EveryFormat, PassesOverMessages) {
  const auto reader = open_bag(fixture(GetParam().name));
  std::set<std::size_t> images;
  for (std::size_t i = 0; i < reader->topics().size(); ++i)
    if (reader->topics()[i].name == "/camera/image_raw") images.insert(i);
  reader->choose(images);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(reader->pass_over());
  ASSERT_TRUE(reader->next_time());
  EXPECT_EQ(reader->next_time()->ns, stamp_ns(5) + 17'000'000);
  const auto message = reader->next();
  ASSERT_TRUE(message);
  EXPECT_THAT(std::string(message->bytes), HasSubstr(picture_bytes(5)));
  EXPECT_TRUE(reader->pass_over());
  EXPECT_TRUE(reader->pass_over());
  EXPECT_FALSE(reader->pass_over());
  EXPECT_EQ(reader->next_time(), std::nullopt);
}

TEST(BagReader, ReadsAFolderOfMcapFiles) {
  const fs::path folder = temporary_folder();
  fs::copy_file(fixture("zstd.mcap"), folder / "any_0.mcap");
  write_bytes(
      (folder / "metadata.yaml").string(),
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  relative_file_paths:\n"
      "    - old_folder/any_0.mcap\n");
  ASSERT_TRUE(is_bag(folder));
  EXPECT_EQ(read_all(*open_bag(folder)).size(), expected_messages().size());
}

TEST(BagReader, ReadsAFolderWhoseRecorderWasKilled) {
  const fs::path folder = temporary_folder();
  for (const char* name : {"split_0.db3", "split_1.db3"})
    fs::copy_file(fixture("split/") + name, folder / name);
  const auto expect_whole = [&](const std::string& fault) {
    std::string told;
    ASSERT_TRUE(is_bag(folder));
    const auto reader = open_bag(folder, [&](LogLevel, std::string_view text) { told += text; });
    EXPECT_EQ(read_all(*reader).size(), expected_messages().size());
    EXPECT_THAT(told, HasSubstr(fault));
  };
  expect_whole("there is no metadata.yaml");
  write_bytes((folder / "metadata.yaml").string(), "");
  expect_whole("metadata.yaml is empty");
  write_bytes((folder / "metadata.yaml").string(), "rosbag2_bagfile_information:\n  version: [5\n");
  expect_whole("metadata.yaml cannot be read");
}

/// As of two publishers of one topic.
TEST(BagReader, JoinsRowsOfOneTopicInSqlite) {
  const fs::path bag = temporary_folder() / "two.db3";
  {
    Db3Recorder recorder(bag);
    recorder.add({"/notes", "std_msgs/String", 1, "a"});
    recorder.run(
        "INSERT INTO topics VALUES (2, '/notes', 'std_msgs/msg/String', 'cdr', '');"
        "INSERT INTO messages (topic_id, timestamp, data) VALUES (2, 2, x'62')");
  }
  const auto reader = open_bag(bag);
  ASSERT_EQ(reader->topics().size(), 1u);
  EXPECT_EQ(reader->topics()[0].count, 2u);
  EXPECT_EQ(read_all(*reader, {"/notes"}).size(), 2u);
}

/// Two recorders at once.
TEST(BagReader, JoinsFilesThatOverlapInTime) {
  const fs::path folder = temporary_folder();
  const auto message = [](std::int64_t time_ns) {
    return TestMessage{"/notes", "std_msgs/String", time_ns, std::to_string(time_ns)};
  };
  write_mcap(folder / "a_0.mcap", Wire::kCdr, {message(10), message(30), message(50)});
  write_mcap(folder / "a_1.mcap", Wire::kCdr, {message(20), message(40), message(60)});
  std::string order;
  for (const Given& given : read_all(*open_bag(folder))) order += given.bytes + " ";
  EXPECT_EQ(order, "10 20 30 40 50 60 ");
}

/// Writers tell a type once: the second topic's chunk, of a file that was cut off, has its channel alone.
TEST(BagReader, KnowsTheTypeOfEveryTopicOfACutFile) {
  const fs::path bag = temporary_folder() / "cut.mcap";
  write_mcap(bag, Wire::kCdr,
             {{"/left", "sensor_msgs/Image", 1, "a"}, {"/right", "sensor_msgs/Image", 2, "b"}}, 1);
  const auto reader = open_bag(bag);
  ASSERT_EQ(reader->topics().size(), 2u);
  for (const BagTopic& topic : reader->topics()) {
    EXPECT_EQ(topic.type, "sensor_msgs/msg/Image") << topic.name;
    EXPECT_EQ(topic.schema_encoding, "ros2msg") << topic.name;
    EXPECT_EQ(topic.count, 1u) << topic.name;
  }
}

/// Each search for the next record ends some bytes on.
TEST(BagReader, PassesOverAMillionBrokenRecords) {
  const fs::path bag = temporary_folder() / "broken.mcap";
  std::string bytes("\x89MCAP0\r\n", 8);
  for (int i = 0; i < 1'000'000; ++i) bytes += std::string("\x05\0\0\0\0\0\0\0\0", 9);
  write_bytes(bag, bytes);
  EXPECT_EQ(read_all(*open_bag(bag)).size(), 0u);
}

TEST(BagReader, RefusesOtherStoragesAndCompressionsByName) {
  const fs::path folder = temporary_folder();
  const auto metadata = [&](const std::string& storage, const std::string& compression) {
    write_bytes((folder / "metadata.yaml").string(),
                "rosbag2_bagfile_information:\n  storage_identifier: " + storage +
                    "\n  compression_format: " + compression + "\n  relative_file_paths: [a.x]\n");
    return message_of([&] { open_bag(folder); });
  };
  EXPECT_THAT(metadata("rocksdb", "''"),
              testing::AllOf(HasSubstr("metadata.yaml:2"), HasSubstr("'rocksdb' is not read")));
  EXPECT_THAT(metadata("sqlite3", "lz5"), HasSubstr("'lz5' is not read"));
}

TEST(BagReader, RefusesOtherVersionsByNumber) {
  const std::string path = (temporary_folder() / "old").string();
  write_bytes(path, "#ROSBAG V1.2\n" + std::string(100, '\0'));
  EXPECT_THAT(message_of([&] { open_bag(path); }), HasSubstr("version 1.2"));
  write_bytes(path, "\x89MCAP1\r\n" + std::string(100, '\0'));
  EXPECT_THAT(message_of([&] { open_bag(path); }), HasSubstr("major version '1'"));
}

TEST(BagReader, RefusesOtherPackingsOfMcapByName) {
  std::string bytes = read_bytes(fixture("zstd.mcap"));
  for (std::size_t at = bytes.find("zstd"); at != std::string::npos; at = bytes.find("zstd", at))
    bytes.replace(at, 4, "lzip");
  for (std::size_t i = 0; i < 4; ++i) bytes[bytes.size() - 12 + i] = '\0';  // the summary's CRC: none is told
  const std::string path = (temporary_folder() / "any.mcap").string();
  write_bytes(path, bytes);
  EXPECT_THAT(message_of([&] { open_bag(path); }),
              testing::AllOf(HasSubstr("any.mcap"), HasSubstr("packed by 'lzip'")));
}

TEST(BagReader, RefusesADatabaseThatIsNoBag) {
  // The header of an empty database, as SQLite's file format describes it
  // (https://sqlite.org/fileformat2.html).
  std::string bytes("SQLite format 3\0\x02\x00\x01\x01\x00\x40\x20\x20", 24);
  bytes += std::string("\0\0\0\x01\0\0\0\x01", 8) + std::string(16, '\0');
  bytes += std::string("\0\0\0\x04\0\0\0\0\0\0\0\0\0\0\0\x01", 16) + std::string(36, '\0');
  bytes += std::string("\x0d\0\0\0\0\x02\0\0", 8);
  bytes.resize(512, '\0');
  const std::string path = (temporary_folder() / "any").string();
  write_bytes(path, bytes);
  EXPECT_THAT(message_of([&] { open_bag(path); }), HasSubstr("no table 'topics'"));
}

TEST(BagReader, KnowsWhatIsNoBag) {
  const fs::path folder = temporary_folder();
  write_bytes((folder / "a.bag").string(), "a text");
  EXPECT_FALSE(is_bag(folder / "a.bag"));
  EXPECT_FALSE(is_bag(folder));
  EXPECT_FALSE(is_bag(folder / "not there"));
  EXPECT_THAT(message_of([&] { open_bag(folder / "a.bag"); }, ErrorKind::kIo), HasSubstr("is no bag"));
  EXPECT_THAT(message_of([&] { open_bag(folder / "not there"); }, ErrorKind::kIo), HasSubstr("No such file"));
}

}  // namespace
}  // namespace apriltrack::test
