#include "mcap_scan.h"

#include <algorithm>
#include <optional>

#include "mcap_data.h"
#include "search_window.h"

namespace apriltrack {
namespace {

constexpr std::uint64_t kBytesOfChain = 1 << 16;

/// A chunk whose record begins at `position`, and whose size cannot be right.
std::optional<Chunk> doubtful_chunk(const RandomAccessFile& file, std::uint64_t position) {
  try {
    const McapPrefix prefix = read_mcap_prefix(file, position);
    if (prefix.op != McapOp::kChunk) return std::nullopt;
    const std::string start = file.read(prefix.content, kMostChunkHeaderBytes);
    const McapChunkHeader header = read_chunk_header(start);
    const auto packing = packing_of(header.compression);
    if (!packing || prefix.content + header.header_size >= file.size()) return std::nullopt;
    Chunk chunk{.offset = position,
                .data_offset = prefix.content + header.header_size,
                .unpacked_size = header.unpacked_size,
                .packing = packing,
                .crc = header.crc,
                .is_partial = true};
    return chunk;
  } catch (const BadBytes&) {
    return std::nullopt;
  }
}

bool is_single(const FileLayout& layout) {
  return !layout.single_messages.empty() && layout.single_messages.back().chunk + 1 == layout.chunks.size();
}

/// Where the next record begins, from a place on that is none, or one that goes on beyond the file.
std::uint64_t find_next(const RandomAccessFile& file, SearchWindow& window, std::uint64_t position,
                        FileLayout& layout, Damage& damage) {
  auto chunk = doubtful_chunk(file, position);
  // What is packed holds pieces that look like records.
  const bool only_chunks = chunk && chunk->packing != Packing::kNone;
  const auto next = window.first(position + 1, [&](std::string_view bytes, std::uint64_t behind) {
    return find_mcap_record(bytes, only_chunks, behind);
  });
  const std::uint64_t end = next.value_or(file.size());
  if (!layout.chunks.empty() && !chunk && !is_single(layout)) layout.chunks.back().has_index = false;
  if (!next) damage.is_cut(position);
  if (chunk && end > chunk->data_offset) {
    chunk->data_size = end - chunk->data_offset;
    layout.chunks.push_back(*chunk);
  } else if (next) {
    damage.lost_bytes(position, end - position);
  }
  return end;
}

}  // namespace

FileLayout scan_mcap(const RandomAccessFile& file, McapChannels& channels, Damage& damage) {
  FileLayout layout;
  SearchWindow window(file, kBytesOfChain);
  std::uint64_t position = kMcapMagic.size();
  bool is_at_end = false;
  while (position < file.size() && !is_at_end) {
    try {
      const McapPrefix prefix = read_mcap_prefix(file, position);
      if (prefix.end() > file.size()) throw BadBytes("a record is longer than the file");
      is_at_end = take_mcap_data(file, prefix, position, channels, layout);
      position = prefix.end();
    } catch (const BadBytes&) {
      position = find_next(file, window, position, layout, damage);
    }
  }
  layout.channels = channels.channels();
  return layout;
}

}  // namespace apriltrack
