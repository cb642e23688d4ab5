#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apriltrack/base/timestamp.h"

namespace apriltrack {

class StagedFiles;

/// How a chunk's bytes are packed.
enum class ChunkPacking { kNone, kLz4, kZstd };

struct McapWriterOptions {
  /// What the messages keep to: "ros2" promises CDR throughout; empty promises nothing.
  std::string profile = {};
  ChunkPacking packing = ChunkPacking::kZstd;
  /// A chunk is written when it has so many bytes, unpacked; it is what the writer holds in memory.
  std::size_t chunk_bytes = std::size_t{1} << 20;
};

/// What the name of the library in McapWriter's files begins with; its version follows.
inline constexpr std::string_view kMcapLibrary = "apriltrack ";

/// Which library wrote an MCAP file, as its header says; nullopt of what is no MCAP file, cannot be read, or
/// has no intact header.
std::optional<std::string> mcap_library(const std::filesystem::path& path);

/// A stream of messages of one type.
struct McapTopic {
  std::string name;              ///< "/tf"
  std::string message_encoding;  ///< "json", "cdr", ...
  std::string schema_name;       ///< "foxglove.FrameTransform"
  std::string schema_encoding;   ///< "jsonschema", "ros2msg", ...
  std::string schema;            ///< The text itself.
};

/// Writes an MCAP file (https://mcap.dev/spec), message by message: chunks with an index of their messages,
/// CRCs of chunks, data and summary, and a summary with statistics, by which players find their way. Memory
/// is that of one chunk, and of some 100 bytes for each chunk written.
///
///   StagedFiles files;
///   McapWriter writer(files, "run.mcap");
///   const auto topic = writer.add({"/pose", "json", "foxglove.PoseInFrame", "jsonschema", schema});
///   writer.write(topic, time, message);
///   writer.close();
///   files.commit();  // now it is there
///
/// A run that ends before that leaves no file of that name, or the old one.
class McapWriter {
 public:
  /// files: must outlive it, and puts the file in place. A path that is a device or a pipe is written to
  /// directly. Throws Error(kIo) when it cannot be written.
  McapWriter(StagedFiles& files, const std::filesystem::path& path, const McapWriterOptions& options = {});
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// What write() calls the topic; at most 65535. Topics of one schema share it.
  std::uint16_t add(const McapTopic& topic);
  /// Requires a topic of add(). Throws Error(kInvalidInput) for a time before 1970, which MCAP cannot hold,
  /// Error(kIo) when the disk is full.
  void write(std::uint16_t topic, Timestamp time, std::string_view message);
  /// Completes the file. Throws Error(kIo).
  void close();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace apriltrack
