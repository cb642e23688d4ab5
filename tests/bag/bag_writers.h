#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

struct sqlite3;

namespace apriltrack::test {

// Small writers of bags, for what the files of other projects' writers (tests/bag/data) do not have. The
// readers are judged by those; these follow the same documents.

/// kJson, kProtobuf: of MCAP, messages are text or protobuf's bytes, and types as they are given.
enum class Wire { kRos1, kCdr, kCdrBigEndian, kJson, kProtobuf };

/// One message after the other, as ROS 1 or CDR serialises them.
class MessageBytes {
 public:
  explicit MessageBytes(Wire wire);
  MessageBytes& u8(std::uint8_t value) { return number(value, 1); }
  MessageBytes& u32(std::uint64_t value) { return number(value, 4); }
  MessageBytes& real(double value);
  MessageBytes& text(const std::string& value);
  MessageBytes& bytes(const std::string& value);
  /// std_msgs/Header
  MessageBytes& header(std::int64_t stamp_ns);
  const std::string& done() const { return bytes_; }

 private:
  MessageBytes& number(std::uint64_t value, std::size_t size);

  Wire wire_;
  std::string bytes_;
};

struct ImageFields {
  std::int64_t stamp_ns = 0;
  int width = 0;
  int height = 0;
  std::string encoding = "mono8";
  bool is_big_endian = false;
  int step = 0;
  std::string data = {};
};

std::string image_message(Wire wire, const ImageFields& fields);
std::string compressed_image_message(Wire wire, std::int64_t stamp_ns, const std::string& format,
                                     const std::string& data);

struct CameraInfoFields {
  int width = 0;
  int height = 0;
  std::string model = "plumb_bob";
  std::vector<double> d = {};
  std::vector<double> k = std::vector<double>(9, 0.0);
  std::vector<double> p = std::vector<double>(12, 0.0);
  int binning_x = 0;
  int binning_y = 0;
  int roi_x = 0;
  int roi_y = 0;
  int roi_width = 0;
  int roi_height = 0;
};

std::string camera_info_message(Wire wire, const CameraInfoFields& fields);

struct TestMessage {
  std::string topic;
  std::string type;  ///< "sensor_msgs/Image".
  std::int64_t log_time_ns = 0;
  std::string bytes;
};

/// How a chunk is packed, and what its header says of it.
struct ChunkForm {
  std::string compression = {};                              ///< As its header names it; empty: as it is.
  std::function<std::string(const std::string&)> pack = {};  ///< Of that compression.
  bool has_crc = false;                                      ///< MCAP.
  int size_error = 0;  ///< Of the size that the header says, less the true one.
};

/// All of one chunk.
void write_ros1_bag(const std::filesystem::path& path, const std::vector<TestMessage>& messages,
                    const ChunkForm& form = {});
/// A chunk for every so many messages, without indices; each type and topic is told once, as other writers
/// do. wire: of the messages.
void write_mcap(const std::filesystem::path& path, Wire wire, const std::vector<TestMessage>& messages,
                std::size_t messages_per_chunk = 4, const ChunkForm& form = {});
/// A SQLite file of rosbag2 while it is recorded.
class Db3Recorder {
 public:
  /// pragmas: run before the tables are made.
  explicit Db3Recorder(const std::filesystem::path& path, const std::string& pragmas = "");
  ~Db3Recorder();
  Db3Recorder(const Db3Recorder&) = delete;
  Db3Recorder& operator=(const Db3Recorder&) = delete;

  void run(const std::string& sql);
  /// A CDR message.
  void add(const TestMessage& message);

 private:
  void must(int status) const;

  sqlite3* database_ = nullptr;
  std::map<std::string, int> ids_;
};

/// CDR messages.
void write_db3(const std::filesystem::path& path, const std::vector<TestMessage>& messages);

}  // namespace apriltrack::test
