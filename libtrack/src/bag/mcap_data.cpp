#include "mcap_data.h"

#include <fmt/format.h>

#include <algorithm>

namespace apriltrack {
namespace {

constexpr std::uint64_t kIndexHeaderBytes = 2 + 4;

std::string read_small(const RandomAccessFile& file, const McapPrefix& prefix) {
  if (prefix.size > kMostSmallRecordBytes) throw BadBytes("a record is too long");
  return file.read(prefix.content, prefix.size);
}

void add_message(const RandomAccessFile& file, const McapPrefix& prefix, std::uint64_t position,
                 FileLayout& layout) {
  const std::string start = file.read(prefix.content, std::min<std::uint64_t>(prefix.size, 2 + 4 + 8));
  ByteCursor cursor(start);
  const std::uint16_t channel = cursor.u16();
  cursor.u32();  // sequence
  const auto time_ns = static_cast<std::int64_t>(cursor.u64());
  layout.add_single_message(position, prefix.end() - position, channel, time_ns);
}

Chunk scanned_chunk(const RandomAccessFile& file, const McapPrefix& prefix, std::uint64_t position) {
  const std::string start = file.read(prefix.content, kMostChunkHeaderBytes);
  const McapChunkHeader header = read_chunk_header(start);
  if (prefix.size != header.header_size + header.data_size) throw BadBytes("a chunk's lengths do not agree");
  return {.offset = position,
          .data_offset = prefix.content + header.header_size,
          .data_size = header.data_size,
          .unpacked_size = header.unpacked_size,
          .packing = packing_of(header.compression),
          .packing_name = header.compression,
          .crc = header.crc};
}

}  // namespace

McapPrefix read_mcap_prefix(const RandomAccessFile& file, std::uint64_t position) {
  const std::string start = file.read(position, kMcapPrefixBytes);
  ByteCursor cursor(start);
  McapPrefix prefix{.op = static_cast<McapOp>(cursor.u8()), .content = position + kMcapPrefixBytes};
  prefix.size = cursor.u64();
  if (prefix.size > std::uint64_t{1} << 62) throw BadBytes("a record is longer than any file");
  return prefix;
}

void add_message_index(std::string_view content, std::uint64_t at, Chunk& chunk) {
  ByteCursor cursor(content);
  IndexPlace place;
  place.channel = cursor.u16();
  const std::uint64_t bytes = cursor.sized().size();
  if (bytes % kMcapIndexEntryBytes != 0) throw BadBytes("an index is damaged");
  place.count = static_cast<std::uint32_t>(bytes / kMcapIndexEntryBytes);
  place.offset = at + kIndexHeaderBytes;
  if (std::ranges::count(chunk.index, place.channel, &IndexPlace::channel) > 0)
    throw BadBytes("an index is there twice");
  chunk.index.push_back(place);
  chunk.has_index = true;
}

bool take_mcap_data(const RandomAccessFile& file, const McapPrefix& prefix, std::uint64_t position,
                    McapChannels& channels, FileLayout& layout) {
  switch (prefix.op) {
    case McapOp::kSchema:
    case McapOp::kChannel:
      channels.take({prefix.op, read_small(file, prefix)});
      return false;
    case McapOp::kMessage:
      add_message(file, prefix, position, layout);
      return false;
    case McapOp::kChunk:
      layout.chunks.push_back(scanned_chunk(file, prefix, position));
      return false;
    case McapOp::kMessageIndex:
      if (layout.chunks.empty()) throw BadBytes("an index without a chunk");
      add_message_index(read_small(file, prefix), prefix.content, layout.chunks.back());
      return false;
    case McapOp::kDataEnd:
    case McapOp::kFooter:
      if (prefix.size != (prefix.op == McapOp::kFooter ? 20 : 4)) throw BadBytes("a record has a wrong size");
      return true;
    default:
      if (static_cast<std::uint8_t>(prefix.op) == 0) throw BadBytes("a record is of no kind that is known");
      return false;
  }
}

}  // namespace apriltrack
