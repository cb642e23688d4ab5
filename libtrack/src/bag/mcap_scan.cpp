#include "mcap_scan.h"

#include <algorithm>
#include <optional>

#include "mcap_data.h"

namespace apriltrack {
namespace {

std::optional<std::uint64_t> search(const RandomAccessFile& file, std::uint64_t from, bool only_chunks) {
  constexpr std::uint64_t kStep = 1 << 20, kOverlap = 1 << 16;
  ByteBuffer buffer;
  for (std::uint64_t begin = from; begin < file.size(); begin += kStep) {
    file.read(begin, kStep + kOverlap, buffer);
    const std::uint64_t behind = file.size() - std::min(file.size(), begin + buffer.size());
    const std::size_t found = find_mcap_record(buffer.view(), only_chunks, behind);
    if (found != std::string_view::npos) return begin + found;
  }
  return std::nullopt;
}

/// A chunk whose record begins at `position`, and whose size cannot be right.
std::optional<Chunk> doubtful_chunk(const RandomAccessFile& file, std::uint64_t position) {
  try {
    const McapPrefix prefix = read_mcap_prefix(file, position);
    if (prefix.op != McapOp::kChunk) return std::nullopt;
    const std::string start = file.read(prefix.content, kMostChunkHeaderBytes);
    const McapChunkHeader header = read_chunk_header(start);
    if (prefix.content + header.header_size >= file.size()) return std::nullopt;
    Chunk chunk{.offset = position,
                .data_offset = prefix.content + header.header_size,
                .unpacked_size = header.unpacked_size,
                .packing = known_packing(header.compression),
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
std::uint64_t find_next(const RandomAccessFile& file, std::uint64_t position, FileLayout& layout,
                        Damage& damage) {
  auto chunk = doubtful_chunk(file, position);
  // What is packed holds pieces that look like records.
  const bool only_chunks = chunk && chunk->packing != Packing::kNone;
  const auto next = search(file, position + 1, only_chunks);
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

FileLayout scan_mcap(const RandomAccessFile& file, Damage& damage) {
  FileLayout layout;
  McapChannels channels;
  std::uint64_t position = kMcapMagic.size();
  bool is_at_end = false;
  while (position < file.size() && !is_at_end) {
    try {
      const McapPrefix prefix = read_mcap_prefix(file, position);
      if (prefix.end() > file.size()) throw BadBytes("a record is longer than the file");
      is_at_end = take_mcap_data(file, prefix, position, channels, layout);
      position = prefix.end();
    } catch (const BadBytes&) {
      position = find_next(file, position, layout, damage);
    }
  }
  layout.channels = channels.channels();
  return layout;
}

}  // namespace apriltrack
