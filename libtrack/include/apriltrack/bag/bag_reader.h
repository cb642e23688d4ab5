#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/base/log.h"
#include "apriltrack/base/timestamp.h"

namespace apriltrack {

/// A stream of messages of one type. A topic that was recorded with two types is two of these.
struct BagTopic {
  std::string name;             ///< "/camera/image_raw".
  std::string type;             ///< As the bag has it: "sensor_msgs/Image" or "sensor_msgs/msg/Image".
  std::string encoding;         ///< Of its messages: "ros1", "cdr", or another word of the bag.
  std::string schema_encoding;  ///< "ros1msg", "ros2msg", ...; empty where the bag tells none.
  std::size_t count = 0;        ///< Messages, as far as the bag tells without reading them.
};

/// One message, or word of one that is lost.
struct BagMessage {
  std::size_t topic = 0;   ///< Index into BagReader::topics().
  Timestamp log_time;      ///< When it was recorded; the message's own time is inside of it.
  std::string_view bytes;  ///< Valid until the next call of next() or choose().
  std::string error;       ///< Why it could not be read; empty for a good one.
};

/// Messages of a recording, whatever its format. Damage costs only what it hit: chunks and messages beyond it
/// are found, and damage() says what was lost. Memory is that of one chunk and of the index of the topics
/// chosen. One call at a time; give each thread its own.
class BagReader {
 public:
  virtual ~BagReader() = default;

  virtual const std::vector<BagTopic>& topics() const = 0;
  /// From now on, and from the beginning, next() gives messages of these topics (indices). None are chosen
  /// at first.
  virtual void choose(const std::set<std::size_t>& topics) = 0;
  /// Of the topics chosen, as far as known before they are read.
  virtual std::size_t num_messages() const = 0;
  /// In the order of log time, messages of one time in the file's order; nullopt at the end. Throws
  /// Error(kIo) where the disk fails.
  virtual std::optional<BagMessage> next() = 0;
  /// Leaves a message out without reading it; false at the end.
  virtual bool pass_over() = 0;
  /// Log time of the message that comes next; nullopt at the end.
  virtual std::optional<Timestamp> next_time() = 0;
  /// What was lost so far, and where, in words without the file's name; empty when nothing was.
  virtual std::string damage() const = 0;
};

/// Whether this is a bag, by its first bytes and not by its name: a ROS 1 bag, an MCAP or SQLite file, one of
/// these packed by zstd, or a folder that rosbag2 recorded. False of what cannot be read.
bool is_bag(const std::filesystem::path& path);

/// Opens a ROS 1 bag (version 2.0; chunks as they are or packed by bz2 or lz4), an MCAP file (chunks as they
/// are or packed by lz4 or zstd, or no chunks), a rosbag2 SQLite file, any of the latter two packed whole by
/// zstd, or a rosbag2 folder of these, which is read as one in the order of time. A packed file is unpacked
/// into the folder for temporary files, where it stays while a reader of it is there (see UnpackedBags).
/// log: hears of a folder without metadata.yaml, of files that it names and are not there, and of unpacking.
/// Throws Error(kIo) when it cannot be read or has nothing intact, Error(kInvalidInput) when it is of a
/// version, storage or compression that is not read.
std::unique_ptr<BagReader> open_bag(const std::filesystem::path& path, const LogSink& log = silent_log());

/// While one of these is there, what was unpacked stays when its reader goes: for programs that open a packed
/// bag several times.
class UnpackedBags {
 public:
  UnpackedBags();
  ~UnpackedBags();
  UnpackedBags(const UnpackedBags&) = delete;
  UnpackedBags& operator=(const UnpackedBags&) = delete;
};

}  // namespace apriltrack
