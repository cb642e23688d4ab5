#include "bag_writers.h"

#include <sqlite3.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <map>
#include <stdexcept>

namespace apriltrack::test {
namespace {

std::string little(std::uint64_t value, std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  return bytes;
}

std::string sized(const std::string& bytes) {
  return little(bytes.size(), 4) + bytes;
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

/// Numbers of the topics, in the order of their first messages.
std::map<std::string, std::uint32_t> numbered(const std::vector<TestMessage>& messages) {
  std::map<std::string, std::uint32_t> ids;
  for (const TestMessage& one : messages) ids.insert({one.topic, static_cast<std::uint32_t>(ids.size() + 1)});
  return ids;
}

/// CRC-32 of ISO-HDLC, bit by bit.
std::uint32_t crc_of(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320 : 0);
  }
  return ~crc;
}

std::uint64_t told_size(const std::string& chunk, const ChunkForm& form) {
  return chunk.size() + static_cast<std::uint64_t>(std::int64_t{form.size_error});
}

std::string packed(const std::string& chunk, const ChunkForm& form) {
  return form.pack ? form.pack(chunk) : chunk;
}

/// What an MCAP file calls it.
struct WireWords {
  std::string profile;
  std::string schema;
  std::string message;
};

WireWords words_of(Wire wire) {
  if (wire == Wire::kRos1) return {"ros1", "ros1msg", "ros1"};
  if (wire == Wire::kJson) return {"", "jsonschema", "json"};
  if (wire == Wire::kProtobuf) return {"", "protobuf", "protobuf"};
  return {"ros2", "ros2msg", "cdr"};
}

std::string ros2_type(const std::string& type) {
  return type.substr(0, type.find('/')) + "/msg" + type.substr(type.find('/'));
}

}  // namespace

MessageBytes::MessageBytes(Wire wire) : wire_(wire) {
  if (wire == Wire::kCdr) bytes_ = std::string("\0\1\0\0", 4);
  if (wire == Wire::kCdrBigEndian) bytes_ = std::string("\0\0\0\0", 4);
}

MessageBytes& MessageBytes::number(std::uint64_t value, std::size_t size) {
  if (wire_ != Wire::kRos1)
    while ((bytes_.size() - 4) % size != 0) bytes_ += '\0';
  std::string raw = little(value, size);
  if (wire_ == Wire::kCdrBigEndian) std::ranges::reverse(raw);
  bytes_ += raw;
  return *this;
}

MessageBytes& MessageBytes::real(double value) {
  return number(std::bit_cast<std::uint64_t>(value), 8);
}

MessageBytes& MessageBytes::text(const std::string& value) {
  return bytes(wire_ == Wire::kRos1 ? value : value + std::string(1, '\0'));
}

MessageBytes& MessageBytes::bytes(const std::string& value) {
  u32(value.size());
  bytes_ += value;
  return *this;
}

MessageBytes& MessageBytes::header(std::int64_t stamp_ns) {
  if (wire_ == Wire::kRos1) u32(7);
  u32(static_cast<std::uint64_t>(stamp_ns / 1'000'000'000));
  u32(static_cast<std::uint64_t>(stamp_ns % 1'000'000'000));
  return text("camera");
}

std::string image_message(Wire wire, const ImageFields& fields) {
  MessageBytes message(wire);
  message.header(fields.stamp_ns)
      .u32(static_cast<std::uint64_t>(fields.height))
      .u32(static_cast<std::uint64_t>(fields.width))
      .text(fields.encoding)
      .u8(fields.is_big_endian ? 1 : 0)
      .u32(static_cast<std::uint64_t>(fields.step))
      .bytes(fields.data);
  return message.done();
}

std::string compressed_image_message(Wire wire, std::int64_t stamp_ns, const std::string& format,
                                     const std::string& data) {
  return MessageBytes(wire).header(stamp_ns).text(format).bytes(data).done();
}

std::string camera_info_message(Wire wire, const CameraInfoFields& fields) {
  MessageBytes message(wire);
  const auto whole = [&](int value) { message.u32(static_cast<std::uint64_t>(value)); };
  const auto reals = [&](const std::vector<double>& values) {
    for (const double value : values) message.real(value);
  };
  message.header(5'000'000'000);
  whole(fields.height);
  whole(fields.width);
  message.text(fields.model);
  message.u32(fields.d.size());
  reals(fields.d);
  reals(fields.k);
  reals(std::vector<double>(9, 0.5));
  reals(fields.p);
  for (const int value :
       {fields.binning_x, fields.binning_y, fields.roi_x, fields.roi_y, fields.roi_height, fields.roi_width})
    whole(value);
  message.u8(0);
  return message.done();
}

void write_ros1_bag(const std::filesystem::path& path, const std::vector<TestMessage>& messages,
                    const ChunkForm& form) {
  const auto record = [](const std::vector<std::pair<std::string, std::string>>& fields,
                         const std::string& data) {
    std::string header;
    for (const auto& [name, value] : fields) header += sized(name + "=" + value);
    return sized(header) + sized(data);
  };
  const auto time = [](std::int64_t ns) {
    return little(static_cast<std::uint64_t>(ns / 1'000'000'000), 4) +
           little(static_cast<std::uint64_t>(ns % 1'000'000'000), 4);
  };
  std::string chunk;
  const auto ids = numbered(messages);
  std::map<std::string, bool> is_told;
  for (const TestMessage& one : messages) {
    const std::string id = little(ids.at(one.topic), 4);
    if (!std::exchange(is_told[one.topic], true))
      chunk += record({{"conn", id}, {"op", "\x07"}, {"topic", one.topic}},
                      sized("topic=" + one.topic) + sized("type=" + one.type));
    chunk += record({{"conn", id}, {"op", "\x02"}, {"time", time(one.log_time_ns)}}, one.bytes);
  }
  std::string bytes = "#ROSBAG V2.0\n";
  bytes += record({{"chunk_count", little(0, 4)},
                   {"conn_count", little(0, 4)},
                   {"index_pos", little(0, 8)},
                   {"op", "\x03"}},
                  std::string(4027, ' '));
  bytes += record({{"compression", form.compression.empty() ? "none" : form.compression},
                   {"op", "\x05"},
                   {"size", little(told_size(chunk, form), 4)}},
                  packed(chunk, form));
  write_file(path, bytes);
}

void write_mcap(const std::filesystem::path& path, Wire wire, const std::vector<TestMessage>& messages,
                std::size_t messages_per_chunk, const ChunkForm& form) {
  const auto record = [](char op, const std::string& content) {
    return op + little(content.size(), 8) + content;
  };
  const WireWords words = words_of(wire);
  const bool is_ros2 = wire == Wire::kCdr || wire == Wire::kCdrBigEndian;
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string bytes = magic + record(1, sized(words.profile) + sized("test"));
  const auto ids = numbered(messages);
  std::map<std::string, std::string> schema_of_type;
  std::map<std::string, bool> has_channel;
  for (std::size_t begin = 0; begin < messages.size(); begin += messages_per_chunk) {
    std::string chunk;
    for (std::size_t i = begin; i < std::min(messages.size(), begin + messages_per_chunk); ++i) {
      const TestMessage& one = messages[i];
      const std::string id = little(ids.at(one.topic), 2);
      const auto [schema, is_new] =
          schema_of_type.try_emplace(one.type, little(schema_of_type.size() + 1, 2));
      if (is_new)
        chunk += record(3, schema->second + sized(is_ros2 ? ros2_type(one.type) : one.type) +
                               sized(words.schema) + sized(""));
      if (!std::exchange(has_channel[one.topic], true))
        chunk += record(4, id + schema->second + sized(one.topic) + sized(words.message) + sized(""));
      const std::string time = little(static_cast<std::uint64_t>(one.log_time_ns), 8);
      chunk += record(5, id + little(i, 4) + time + time + one.bytes);
    }
    const std::string data = packed(chunk, form);
    bytes += record(6, std::string(16, '\0') + little(told_size(chunk, form), 8) +
                           little(form.has_crc ? crc_of(chunk) : 0, 4) + sized(form.compression) +
                           little(data.size(), 8) + data);
  }
  bytes += record(15, little(0, 4)) + record(2, std::string(20, '\0')) + magic;
  write_file(path, bytes);
}

Db3Recorder::Db3Recorder(const std::filesystem::path& path, const std::string& pragmas) {
  must(sqlite3_open(path.c_str(), &database_));
  run(pragmas);
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
      " timestamp INTEGER NOT NULL, data BLOB NOT NULL);");
}

Db3Recorder::~Db3Recorder() {
  sqlite3_close(database_);
}

void Db3Recorder::must(int status) const {
  if (status != SQLITE_OK && status != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(database_));
}

void Db3Recorder::run(const std::string& sql) {
  must(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr));
}

void Db3Recorder::add(const TestMessage& message) {
  sqlite3_stmt* statement = nullptr;
  const auto [id, is_new] = ids_.insert({message.topic, static_cast<int>(ids_.size() + 1)});
  if (is_new) {
    must(sqlite3_prepare_v2(database_, "INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", -1, &statement,
                            nullptr));
    sqlite3_bind_int64(statement, 1, id->second);
    sqlite3_bind_text(statement, 2, message.topic.c_str(), -1, SQLITE_TRANSIENT);
    sqlite3_bind_text(statement, 3, ros2_type(message.type).c_str(), -1, SQLITE_TRANSIENT);
    must(sqlite3_step(statement));
    sqlite3_finalize(statement);
  }
  must(sqlite3_prepare_v2(database_, "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", -1,
                          &statement, nullptr));
  sqlite3_bind_int64(statement, 1, id->second);
  sqlite3_bind_int64(statement, 2, message.log_time_ns);
  sqlite3_bind_blob(statement, 3, message.bytes.data(), static_cast<int>(message.bytes.size()),
                    SQLITE_TRANSIENT);
  must(sqlite3_step(statement));
  sqlite3_finalize(statement);
}

void write_db3(const std::filesystem::path& path, const std::vector<TestMessage>& messages) {
  Db3Recorder recorder(path);
  recorder.run("BEGIN");
  for (const TestMessage& one : messages) recorder.add(one);
  recorder.run("COMMIT");
}

}  // namespace apriltrack::test
