#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "byte_cursor.h"
#include "chunk_layout.h"

namespace apriltrack {

// Records of ROS 1 bags, version 2.0 (https://wiki.ros.org/Bags/Format/2.0): a header of fields "name=value",
// and data, each behind its length in four bytes.

enum class Ros1Op : std::uint8_t {
  kMessage = 0x02,
  kFileHeader = 0x03,
  kIndex = 0x04,
  kChunk = 0x05,
  kChunkInfo = 0x06,
  kConnection = 0x07,
};

/// Fields of a record's header, or of a connection's data. Views of the bytes it was read from.
class Ros1Fields {
 public:
  /// Throws BadBytes unless all bytes are fields.
  explicit Ros1Fields(std::string_view bytes);

  std::optional<std::string_view> find(std::string_view name) const;
  /// All throw BadBytes where the field is missing or has another size.
  std::string_view text(std::string_view name) const;
  Ros1Op op() const { return static_cast<Ros1Op>(number("op", 1)); }
  std::uint32_t u32(std::string_view name) const { return static_cast<std::uint32_t>(number(name, 4)); }
  std::uint64_t u64(std::string_view name) const { return number(name, 8); }
  std::int64_t time_ns(std::string_view name) const;

 private:
  std::uint64_t number(std::string_view name, std::size_t size) const;

  struct Field {
    std::string_view name;
    std::string_view value;
  };
  std::vector<Field> fields_;
};

/// Seconds and nanoseconds, four bytes each.
std::int64_t ros1_time_ns(std::string_view eight_bytes);

/// Number and channel of a connection record. Throws BadBytes.
std::uint32_t connection_id(const Ros1Fields& header);
BagChannel connection_channel(const Ros1Fields& header, std::string_view data);

/// All records of an unpacked chunk; see ChunkedFormat::walk.
ChunkContents walk_ros1(std::string_view unpacked, const std::vector<std::uint32_t>& hints);

/// Fewer bytes are no header of a chunk's record; more, of any record, are none that a writer made.
inline constexpr std::uint32_t kMostHeaderBytes = 1 << 20;

/// Where in `bytes` the record of a chunk begins, if it does; npos otherwise. from: the first place that
/// counts.
std::size_t find_chunk_record(std::string_view bytes, std::size_t from);

}  // namespace apriltrack
