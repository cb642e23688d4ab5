#include "mcap_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "crc32.h"
#include "mcap_records.h"

namespace apriltrack {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::uint64_t kFooterBytes = kMcapPrefixBytes + 20;
/// Two numbers of eight bytes for each message.
constexpr std::uint64_t kIndexEntryBytes = 16;
constexpr std::uint64_t kIndexHeaderBytes = 2 + 4;
/// Schemas of deep types have some 100 kB.
constexpr std::uint64_t kMostSmallRecordBytes = std::uint64_t{64} << 20;

struct Prefix {
  McapOp op = McapOp::kHeader;
  std::uint64_t content = 0;  ///< Where it begins.
  std::uint64_t size = 0;
  std::uint64_t end() const { return content + size; }
};

class McapFile : public ChunkedFormat {
 public:
  explicit McapFile(std::shared_ptr<const RandomAccessFile> file) : file_(std::move(file)) {
    check_version();
  }

  FileLayout lay_out(Damage& damage) override {
    if (auto layout = by_summary(damage)) return std::move(*layout);
    return by_scan(damage);
  }

  ChunkContents walk(std::string_view unpacked, const std::vector<std::uint32_t>& hints) const override {
    return walk_mcap(unpacked, hints);
  }

  std::vector<MessagePlace> read_index(const IndexPlace& place) const override {
    const std::string bytes = file_->read(place.offset, kIndexEntryBytes * place.count);
    ByteCursor cursor(bytes);
    std::vector<MessagePlace> entries;
    for (std::uint32_t i = 0; i < place.count; ++i) {
      const auto time_ns = static_cast<std::int64_t>(cursor.u64());
      const std::uint64_t offset = cursor.u64();
      if (offset > kMostUnpackedBytes) throw BadBytes("an index is damaged");
      entries.push_back({time_ns, 0, place.channel, static_cast<std::uint32_t>(offset)});
    }
    return entries;
  }

 private:
  void check_version() const {
    const std::string start = file_->read(0, kMagic.size());
    if (start == kMagic) return;
    if (start.size() == kMagic.size() && start.substr(6) == kMagic.substr(6))
      throw invalid_input(
          file_->name(),
          fmt::format("is an MCAP file of major version '{}'; only version '0' is read", start[5]));
    throw io_error(file_->name(), "begins like an MCAP file, but its first 8 bytes are damaged");
  }

  // By the summary at the end of the file.

  std::optional<FileLayout> by_summary(Damage& damage) {
    try {
      return read_summary(damage);
    } catch (const BadBytes&) {
      is_closed_ = false;
      return std::nullopt;
    }
  }

  std::optional<FileLayout> read_summary(Damage& damage) {
    const std::uint64_t tail = kFooterBytes + kMagic.size();
    if (file_->size() < kMagic.size() + tail) return std::nullopt;
    const std::uint64_t footer_offset = file_->size() - tail;
    const std::string end = file_->read(footer_offset, tail);
    if (!end.ends_with(kMagic)) return std::nullopt;
    ByteCursor cursor(end);
    const McapRecord footer = take_mcap_record(cursor);
    if (footer.op != McapOp::kFooter || footer.content.size() != 20) return std::nullopt;
    ByteCursor fields(footer.content);
    const std::uint64_t summary_start = fields.u64();
    fields.u64();  // of the offsets
    const std::uint32_t crc = fields.u32();
    is_closed_ = summary_start == 0;  // a summary may be left out
    if (summary_start < kMagic.size() || summary_start > footer_offset) return std::nullopt;
    const std::string summary = file_->read(summary_start, file_->size() - kMagic.size() - 4 - summary_start);
    if (crc != 0 && crc32(summary) != crc) return std::nullopt;
    is_closed_ = true;
    return layout_of(std::string_view(summary).substr(0, footer_offset - summary_start), summary_start,
                     damage);
  }

  std::optional<FileLayout> layout_of(std::string_view summary, std::uint64_t summary_start,
                                      Damage& damage) const {
    FileLayout layout;
    McapChannels channels;
    std::optional<Counts> counts;
    ByteCursor cursor(summary);
    while (!cursor.is_at_end()) {
      const McapRecord record = take_mcap_record(cursor);
      if (record.op == McapOp::kChunkIndex) layout.chunks.push_back(indexed_chunk(record.content));
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
    std::uint64_t begin = kMagic.size();
    for (Chunk& chunk : chunks) {
      chunk.has_index = false;
      look_between(begin, chunk.offset, channels, layout, damage);
      begin = chunk.data_offset + chunk.data_size;
      layout.chunks.push_back(std::move(chunk));
    }
    look_between(begin, summary_start, channels, layout, damage);
    layout.channels = channels.channels();
    return layout;
  }

  /// Takes the messages that lie between two chunks.
  void look_between(std::uint64_t begin, std::uint64_t end, McapChannels& channels, FileLayout& layout,
                    Damage& damage) const {
    try {
      while (begin < end) {
        const Prefix prefix = read_prefix(begin);
        if (prefix.end() > end) throw BadBytes("a record is longer than its place");
        if (prefix.op == McapOp::kChunk) throw BadBytes("a chunk that the summary does not know");
        if (prefix.op != McapOp::kMessageIndex) take(prefix, begin, channels, layout);
        begin = prefix.end();
      }
    } catch (const BadBytes&) {
      damage.lost_bytes(begin, end - begin);
    }
  }

  using Counts = std::map<std::uint32_t, std::uint64_t>;

  static Counts counts_of(std::string_view statistics) {
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
  static Counts counts_of(const FileLayout& layout) {
    Counts counts;
    for (const Chunk& chunk : layout.chunks)
      for (const IndexPlace& place : chunk.index)
        if (place.count > 0) counts[place.channel] += place.count;
    return counts;
  }

  Chunk indexed_chunk(std::string_view index) const {
    ByteCursor cursor(index);
    cursor.take(16);  // first and last time
    Chunk chunk;
    chunk.offset = cursor.u64();
    const std::uint64_t chunk_length = cursor.u64();
    cursor.sized();  // where the indices are: behind the chunk
    const std::uint64_t indices_length = cursor.u64();
    const std::string_view compression = cursor.sized();
    chunk.data_size = cursor.u64();
    chunk.unpacked_size = cursor.u64();
    if (chunk.offset > file_->size() || chunk_length > file_->size() - chunk.offset ||
        chunk.data_size > chunk_length || indices_length > kMostSmallRecordBytes)
      throw BadBytes("the index of a chunk is damaged");
    chunk.packing = known_packing(compression);
    // The fields before the packed bytes have a fixed size, but for the name.
    const std::string start = file_->read(chunk.offset + kMcapPrefixBytes, kMostChunkHeaderBytes);
    chunk.crc = read_chunk_header(start).crc;
    chunk.data_offset = chunk.offset + chunk_length - chunk.data_size;
    try {
      read_indices(chunk.offset + chunk_length, indices_length, chunk);
    } catch (const BadBytes&) {
      chunk.index.clear();
      chunk.has_index = false;
    }
    return chunk;
  }

  /// The message indices behind a chunk.
  void read_indices(std::uint64_t offset, std::uint64_t length, Chunk& chunk) const {
    const std::string indices = file_->read(offset, length);
    ByteCursor records(indices);
    while (!records.is_at_end()) {
      const std::uint64_t begin = offset + records.position();
      const McapRecord record = take_mcap_record(records);
      if (record.op != McapOp::kMessageIndex) throw BadBytes("the index of a chunk is damaged");
      add_index(record.content, begin + kMcapPrefixBytes, chunk);
    }
  }

  Packing known_packing(std::string_view compression) const {
    if (const auto packing = packing_of(compression)) return *packing;
    throw BadBytes(fmt::format("a chunk is packed by '{}'", compression));
  }

  /// content: of a message index, whole; at: where it begins in the file.
  static void add_index(std::string_view content, std::uint64_t at, Chunk& chunk) {
    ByteCursor cursor(content);
    IndexPlace place;
    place.channel = cursor.u16();
    const std::uint64_t bytes = cursor.sized().size();
    if (bytes % kIndexEntryBytes != 0) throw BadBytes("an index is damaged");
    place.count = static_cast<std::uint32_t>(bytes / kIndexEntryBytes);
    place.offset = at + kIndexHeaderBytes;
    if (std::ranges::count(chunk.index, place.channel, &IndexPlace::channel) > 0)
      throw BadBytes("an index is there twice");
    chunk.index.push_back(place);
    chunk.has_index = true;
  }

  // From the beginning on, where there is no summary.

  FileLayout by_scan(Damage& damage) const {
    FileLayout layout;
    McapChannels channels;
    std::uint64_t position = kMagic.size();
    bool is_at_end = false;
    while (position < file_->size() && !is_at_end) {
      try {
        const Prefix prefix = read_prefix(position);
        if (prefix.end() > file_->size()) throw BadBytes("a record is longer than the file");
        is_at_end = take(prefix, position, channels, layout);
        position = prefix.end();
      } catch (const BadBytes&) {
        position = find_next(position, layout, damage);
      }
    }
    layout.channels = channels.channels();
    if (!is_closed_) damage.has_no_index();
    return layout;
  }

  Prefix read_prefix(std::uint64_t position) const {
    const std::string start = file_->read(position, kMcapPrefixBytes);
    ByteCursor cursor(start);
    Prefix prefix{.op = static_cast<McapOp>(cursor.u8()), .content = position + kMcapPrefixBytes};
    prefix.size = cursor.u64();
    if (prefix.size > std::uint64_t{1} << 62) throw BadBytes("a record is longer than any file");
    return prefix;
  }

  /// Whether the data end there.
  bool take(const Prefix& prefix, std::uint64_t position, McapChannels& channels, FileLayout& layout) const {
    switch (prefix.op) {
      case McapOp::kSchema:
      case McapOp::kChannel:
        channels.take({prefix.op, read_small(prefix)});
        return false;
      case McapOp::kMessage:
        add_message(prefix, position, layout);
        return false;
      case McapOp::kChunk:
        layout.chunks.push_back(scanned_chunk(prefix, position));
        return false;
      case McapOp::kMessageIndex:
        if (layout.chunks.empty()) throw BadBytes("an index without a chunk");
        add_index(read_small(prefix), prefix.content, layout.chunks.back());
        return false;
      case McapOp::kDataEnd:
      case McapOp::kFooter:
        if (prefix.size != (prefix.op == McapOp::kFooter ? 20 : 4))
          throw BadBytes("a record has a wrong size");
        return true;
      default:
        if (static_cast<std::uint8_t>(prefix.op) == 0) throw BadBytes("a record is of no kind that is known");
        return false;
    }
  }

  void add_message(const Prefix& prefix, std::uint64_t position, FileLayout& layout) const {
    const std::string start = file_->read(prefix.content, std::min<std::uint64_t>(prefix.size, 2 + 4 + 8));
    ByteCursor cursor(start);
    const std::uint16_t channel = cursor.u16();
    cursor.u32();  // sequence
    const auto time_ns = static_cast<std::int64_t>(cursor.u64());
    layout.add_single_message(position, prefix.end() - position, channel, time_ns);
  }

  std::string read_small(const Prefix& prefix) const {
    if (prefix.size > kMostSmallRecordBytes) throw BadBytes("a record is too long");
    return file_->read(prefix.content, prefix.size);
  }

  Chunk scanned_chunk(const Prefix& prefix, std::uint64_t position) const {
    const std::string start = file_->read(prefix.content, kMostChunkHeaderBytes);
    const McapChunkHeader header = read_chunk_header(start);
    Chunk chunk{.offset = position,
                .data_offset = prefix.content + header.header_size,
                .data_size = header.data_size,
                .unpacked_size = header.unpacked_size,
                .packing = known_packing(header.compression),
                .crc = header.crc};
    if (prefix.size != header.header_size + header.data_size)
      throw BadBytes("a chunk's lengths do not agree");
    return chunk;
  }

  /// Where the next record begins, from a place on that is none, or one that goes on beyond the file.
  std::uint64_t find_next(std::uint64_t position, FileLayout& layout, Damage& damage) const {
    auto chunk = doubtful_chunk(position);
    // What is packed holds pieces that look like records.
    const bool only_chunks = chunk && chunk->packing != Packing::kNone;
    const auto next = search(position + 1, only_chunks);
    const std::uint64_t end = next.value_or(file_->size());
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

  static bool is_single(const FileLayout& layout) {
    return !layout.single_messages.empty() && layout.single_messages.back().chunk + 1 == layout.chunks.size();
  }

  /// A chunk whose record begins at `position`, and whose size cannot be right.
  std::optional<Chunk> doubtful_chunk(std::uint64_t position) const {
    try {
      const Prefix prefix = read_prefix(position);
      if (prefix.op != McapOp::kChunk) return std::nullopt;
      const std::string start = file_->read(prefix.content, kMostChunkHeaderBytes);
      const McapChunkHeader header = read_chunk_header(start);
      if (prefix.content + header.header_size >= file_->size()) return std::nullopt;
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

  std::optional<std::uint64_t> search(std::uint64_t from, bool only_chunks) const {
    constexpr std::uint64_t kStep = 1 << 20, kOverlap = 1 << 16;
    ByteBuffer buffer;
    for (std::uint64_t begin = from; begin < file_->size(); begin += kStep) {
      file_->read(begin, kStep + kOverlap, buffer);
      const std::uint64_t behind = file_->size() - std::min(file_->size(), begin + buffer.size());
      const std::size_t found = find_mcap_record(buffer.view(), only_chunks, behind);
      if (found != std::string_view::npos) return begin + found;
    }
    return std::nullopt;
  }

  std::shared_ptr<const RandomAccessFile> file_;
  bool is_closed_ = false;
};

}  // namespace

std::unique_ptr<ChunkedFormat> mcap_file(std::shared_ptr<const RandomAccessFile> file) {
  return std::make_unique<McapFile>(std::move(file));
}

}  // namespace apriltrack
