#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "byte_cursor.h"
#include "chunk_layout.h"

namespace apriltrack {

// Records of MCAP files (https://mcap.dev/spec): an opcode, the length in eight bytes, and the content.

enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

inline constexpr std::uint64_t kMcapPrefixBytes = 9;  ///< Opcode and length.

struct McapRecord {
  McapOp op = McapOp::kHeader;
  std::string_view content;
};

/// Throws BadBytes where it is cut off.
McapRecord take_mcap_record(ByteCursor& cursor);

struct McapSchema {
  std::string name;
  std::string encoding;
};

/// Channels and the schemas that they refer to, gathered from their records.
class McapChannels {
 public:
  /// False of records that are neither schema nor channel. Throws BadBytes.
  bool take(const McapRecord& record);
  const std::map<std::uint32_t, BagChannel>& channels() const { return channels_; }

 private:
  std::map<std::uint16_t, McapSchema> schemas_;
  std::map<std::uint32_t, BagChannel> channels_;
};

/// All records of an unpacked chunk; see ChunkedFormat::walk. channels: as known so far, for a file may have
/// each schema and channel only once, in whatever chunk comes first.
ChunkContents walk_mcap(std::string_view unpacked, const std::vector<std::uint32_t>& hints,
                        McapChannels& channels);

/// Fields of a chunk's record before its bytes.
struct McapChunkHeader {
  std::uint64_t unpacked_size = 0;
  std::uint32_t crc = 0;
  std::string compression;
  std::uint64_t data_size = 0;
  std::uint64_t header_size = 0;  ///< Of these fields.
};

/// start: the first bytes of the record's content. Throws BadBytes.
McapChunkHeader read_chunk_header(std::string_view start);
/// So many bytes are enough for that.
inline constexpr std::uint64_t kMostChunkHeaderBytes = 128;

/// Where in `bytes`, which end `bytes_behind` before the file's end, the next record begins that can be
/// believed to be one: a chunk whose lengths agree or, unless only_chunks, any record that three others
/// follow. npos: none.
std::size_t find_mcap_record(std::string_view bytes, bool only_chunks, std::uint64_t bytes_behind);

}  // namespace apriltrack
