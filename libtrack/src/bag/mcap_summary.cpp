#include "mcap_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/io/crc32.h"
#include "mcap_data.h"

namespace apriltrack {
namespace {

constexpr std::uint64_t kFooterBytes = kMcapPrefixBytes + 20;
/// A chunk has some 200 bytes there; a damaged number must not bring the whole file into memory.
constexpr std::uint64_t kMostSummaryBytes = std::uint64_t{1} << 28;

/// The summary's bytes, and where they begin; nullopt where there is none, or it is damaged.
struct SummaryBytes {
  std::string bytes;
  std::uint64_t begin = 0;
};

std::optional<SummaryBytes> find_summary(const RandomAccessFile& file, bool& is_closed) {
  const std::uint64_t tail = kFooterBytes + kMcapMagic.size();
  if (file.size() < kMcapMagic.size() + tail) return std::nullopt;
  const std::uint64_t footer_offset = file.size() - tail;
  const std::string end = file.read(footer_offset, tail);
  if (!end.ends_with(kMcapMagic)) return std::nullopt;
  ByteCursor cursor(end);
  const McapRecord footer = take_mcap_record(cursor);
  if (footer.op != McapOp::kFooter || footer.content.size() != 20) return std::nullopt;
  ByteCursor fields(footer.content);
  const std::uint64_t begin = fields.u64();
  fields.u64();  // of the offsets
  const std::uint32_t crc = fields.u32();
  is_closed = begin == 0;  // a summary may be left out
  if (begin < kMcapMagic.size() || begin > footer_offset || footer_offset - begin > kMostSummaryBytes)
    return std::nullopt;
  std::string summary = file.read(begin, file.size() - kMcapMagic.size() - sizeof(crc) - begin);
  if (crc != 0 && crc32(summary) != crc) return std::nullopt;
  is_closed = true;
  summary.resize(footer_offset - begin);
  return SummaryBytes{std::move(summary), begin};
}

using Counts = std::map<std::uint32_t, std::uint64_t>;

Counts counts_of(std::string_view statistics) {
  ByteCursor cursor(statistics);
  const std::uint64_t all = cursor.u64();
  cursor.take(2 + 4 + 4 + 4 + 4 + 8 + 8);
  const std::string_view entries = cursor.sized();
  ByteCursor entry(entries);
  Counts counts;
  std::uint64_t sum = 0;
  while (!entry.is_at_end()) {
    const std::uint16_t channel = entry.u16();
    const std::uint64_t count = entry.u64();
    if (count > 0) counts[channel] = count;
    sum += count;
  }
  if (sum != all) throw BadBytes("the statistics do not add up");
  return counts;
}
Counts counts_of(const FileLayout& layout) {
  Counts counts;
  for (const Chunk& chunk : layout.chunks)
    for (const IndexPlace& place : chunk.index)
      if (place.count > 0) counts[place.channel] += place.count;
  return counts;
}

/// The message indices behind a chunk.
void read_indices(const RandomAccessFile& file, std::uint64_t offset, std::uint64_t length, Chunk& chunk) {
  const std::string indices = file.read(offset, length);
  ByteCursor records(indices);
  while (!records.is_at_end()) {
    const std::uint64_t begin = offset + records.position();
    const McapRecord record = take_mcap_record(records);
    if (record.op != McapOp::kMessageIndex) throw BadBytes("the index of a chunk is damaged");
    add_message_index(record.content, begin + kMcapPrefixBytes, chunk);
  }
}

Chunk indexed_chunk(const RandomAccessFile& file, std::string_view index) {
  ByteCursor cursor(index);
  cursor.take(16);  // first and last time
  Chunk chunk;
  chunk.offset = cursor.u64();
  const std::uint64_t chunk_length = cursor.u64();
  cursor.sized();  // where the indices are: behind the chunk
  const std::uint64_t indices_length = cursor.u64();
  const std::string_view compression = cursor.sized();
  chunk.data_size = cursor.u64();
  if (chunk.offset > file.size() || chunk_length > file.size() - chunk.offset ||
      chunk.data_size > chunk_length || indices_length > kMostSmallRecordBytes)
    throw BadBytes("the index of a chunk is damaged");
  const auto packing = packing_of(compression);
  if (!packing)
    throw invalid_input(
        file.name(), fmt::format("has chunks that are packed by '{}'; lz4 and zstd are read", compression));
  chunk.packing = *packing;
  // The fields before the packed bytes have a fixed size, but for the name.
  const std::string start = file.read(chunk.offset + kMcapPrefixBytes, kMostChunkHeaderBytes);
  const McapChunkHeader header = read_chunk_header(start);
  chunk.crc = header.crc;
  chunk.unpacked_size = header.unpacked_size;
  chunk.data_offset = chunk.offset + chunk_length - chunk.data_size;
  try {
    read_indices(file, chunk.offset + chunk_length, indices_length, chunk);
  } catch (const BadBytes&) {
    chunk.index.clear();
    chunk.has_index = false;
  }
  return chunk;
}

/// Takes the messages that lie between two chunks.
void look_between(const RandomAccessFile& file, std::uint64_t begin, std::uint64_t end,
                  McapChannels& channels, FileLayout& layout, Damage& damage) {
  try {
    while (begin < end) {
      const McapPrefix prefix = read_mcap_prefix(file, begin);
      if (prefix.end() > end) throw BadBytes("a record is longer than its place");
      if (prefix.op == McapOp::kChunk) throw BadBytes("a chunk that the summary does not know");
      if (prefix.op != McapOp::kMessageIndex) take_mcap_data(file, prefix, begin, channels, layout);
      begin = prefix.end();
    }
  } catch (const BadBytes&) {
    damage.lost_bytes(begin, end - begin);
  }
}

std::optional<FileLayout> layout_of(const RandomAccessFile& file, std::string_view summary,
                                    std::uint64_t summary_start, McapChannels& channels, Damage& damage) {
  FileLayout layout;
  std::optional<Counts> counts;
  ByteCursor cursor(summary);
  while (!cursor.is_at_end()) {
    const McapRecord record = take_mcap_record(cursor);
    if (record.op == McapOp::kChunkIndex) layout.chunks.push_back(indexed_chunk(file, record.content));
    if (record.op == McapOp::kStatistics) counts = counts_of(record.content);
    channels.take(record);
  }
  std::ranges::sort(layout.chunks, {}, &Chunk::offset);
  if (counts && *counts == counts_of(layout)) {
    layout.channels = channels.channels();
    return layout;
  }
  // The statistics count messages that the indices of the chunks do not have.
  if (layout.chunks.empty()) return std::nullopt;
  std::vector<Chunk> chunks = std::move(layout.chunks);
  layout.chunks.clear();
  std::uint64_t begin = kMcapMagic.size();
  for (Chunk& chunk : chunks) {
    chunk.has_index = false;
    look_between(file, begin, chunk.offset, channels, layout, damage);
    begin = chunk.data_offset + chunk.data_size;
    layout.chunks.push_back(std::move(chunk));
  }
  look_between(file, begin, summary_start, channels, layout, damage);
  layout.channels = channels.channels();
  return layout;
}

}  // namespace

McapSummary read_mcap_summary(const RandomAccessFile& file, McapChannels& channels, Damage& damage) {
  McapSummary summary;
  try {
    if (const auto found = find_summary(file, summary.is_closed))
      summary.layout = layout_of(file, found->bytes, found->begin, channels, damage);
  } catch (const BadBytes&) {
    summary.is_closed = false;
  }
  return summary;
}

}  // namespace apriltrack
