#include "ros1_bag.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "apriltrack/base/error.h"
#include "ros1_records.h"
#include "search_window.h"

namespace apriltrack {
namespace {

constexpr std::string_view kVersion2 = "#ROSBAG V2.0\n";
constexpr std::uint32_t kIndexVersion = 1;
constexpr std::uint64_t kIndexEntryBytes = 12;
constexpr std::uint32_t kMostSmallBytes = 1 << 26;

/// A record of the file, its data left where they are.
struct FileRecord {
  std::string header_bytes;
  std::uint64_t data_offset = 0;
  std::uint32_t data_size = 0;

  Ros1Fields header() const { return Ros1Fields(header_bytes); }
  std::uint64_t end() const { return data_offset + data_size; }
};

class Ros1Bag : public ChunkedFormat {
 public:
  explicit Ros1Bag(std::shared_ptr<const RandomAccessFile> file) : file_(std::move(file)) { check_version(); }

  FileLayout lay_out(Damage& damage) override {
    FileLayout layout;
    std::uint64_t position = kVersion2.size();
    while (position < file_->size()) {
      try {
        const FileRecord record = read_record(position);
        if (record.end() > file_->size()) throw BadBytes("a record is longer than the file");
        take(record, position, layout);
        position = record.end();
      } catch (const BadBytes&) {
        position = find_next(position, layout, damage);
      }
    }
    if (!is_closed_ || counts_.size() < num_chunks_stated_) damage.has_no_index();
    distrust_contradicted(layout);
    return layout;
  }

  ChunkContents walk(std::string_view unpacked, const std::vector<std::uint32_t>& hints) override {
    return walk_ros1(unpacked, hints);
  }

  std::vector<MessagePlace> read_index(const IndexPlace& place) const override {
    const std::string bytes = file_->read(place.offset, kIndexEntryBytes * place.count);
    ByteCursor cursor(bytes);
    std::vector<MessagePlace> entries;
    for (std::uint32_t i = 0; i < place.count; ++i) {
      const std::int64_t time_ns = ros1_time_ns(cursor.take(8));
      entries.push_back({time_ns, 0, place.channel, cursor.u32()});
    }
    return entries;
  }

 private:
  void check_version() const {
    const std::string start = file_->read(0, 64);
    if (start.starts_with(kVersion2)) return;
    const std::string version =
        start.substr(kRos1Magic.size(), start.find_first_of("\r\n") - kRos1Magic.size());
    throw invalid_input(
        file_->name(),
        fmt::format("is a ROS bag of version {}; only version 2.0 is read: bring it to that with "
                    "`rosbag fix` or `rosbag reindex` of ROS 1",
                    version));
  }

  FileRecord read_record(std::uint64_t position) const {
    constexpr std::uint64_t kUsual = 512;
    std::string start = file_->read(position, kUsual);
    const std::uint32_t header_size = ByteCursor(start).u32();
    if (header_size > kMostHeaderBytes) throw BadBytes("a record's header is too long");
    if (header_size + 8 > start.size()) start = file_->read(position, header_size + std::uint64_t{8});
    ByteCursor cursor(start, 4);
    FileRecord record;
    record.header_bytes = cursor.take(header_size);
    record.data_size = cursor.u32();
    record.data_offset = position + cursor.position();
    return record;
  }

  void take(const FileRecord& record, std::uint64_t position, FileLayout& layout) {
    const Ros1Fields header = record.header();
    switch (header.op()) {
      case Ros1Op::kFileHeader:
        refuse_encrypted(header);
        is_closed_ = header.u64("index_pos") != 0 && header.u64("index_pos") <= file_->size();
        num_chunks_stated_ = header.u32("chunk_count");
        return;
      case Ros1Op::kChunk:
        layout.chunks.push_back(chunk_of(record, header, position));
        return;
      case Ros1Op::kIndex:
        add_index(record, header, layout);
        return;
      case Ros1Op::kConnection:
        layout.channels.insert_or_assign(connection_id(header),
                                         connection_channel(header, read_small(record)));
        return;
      case Ros1Op::kChunkInfo:
        counts_[header.u64("chunk_pos")] = read_counts(record, header);
        return;
      case Ros1Op::kMessage:
        layout.add_single_message(position, record.end() - position, header.u32("conn"),
                                  header.time_ns("time"));
        return;
    }
    throw BadBytes("a record is of no kind that is known");
  }

  using CountOfChannel = std::map<std::uint32_t, std::uint32_t>;

  CountOfChannel read_counts(const FileRecord& record, const Ros1Fields& header) const {
    const std::string bytes = read_small(record);
    ByteCursor cursor(bytes);
    CountOfChannel counts;
    for (std::uint32_t i = header.u32("count"); i > 0; --i) {
      const std::uint32_t channel = cursor.u32();
      counts[channel] = cursor.u32();
    }
    return counts;
  }

  /// A chunk's messages are told twice, behind it and at the end of the file.
  void distrust_contradicted(FileLayout& layout) const {
    for (Chunk& chunk : layout.chunks) {
      const auto told = counts_.find(chunk.offset);
      if (told == counts_.end()) continue;
      CountOfChannel counts;
      for (const IndexPlace& place : chunk.index) counts[place.channel] = place.count;
      if (counts != told->second) chunk.has_index = false;
    }
  }

  /// What is no chunk is small; a damaged length must not bring the whole file into memory.
  std::string read_small(const FileRecord& record) const {
    if (record.data_size > kMostSmallBytes) throw BadBytes("a record is too long");
    return file_->read(record.data_offset, record.data_size);
  }

  void refuse_encrypted(const Ros1Fields& header) const {
    const std::string_view encryptor = header.find("encryptor").value_or("");
    if (encryptor.empty()) return;
    throw invalid_input(file_->name(),
                        fmt::format("is encrypted (by {}): decrypt it with `rosbag decompress` or "
                                    "play and record it anew",
                                    encryptor));
  }

  static Chunk chunk_of(const FileRecord& record, const Ros1Fields& header, std::uint64_t position) {
    const std::string_view compression = header.text("compression");
    return {.offset = position,
            .data_offset = record.data_offset,
            .data_size = record.data_size,
            .unpacked_size = header.u32("size"),
            .packing = packing_of(compression),
            .packing_name = std::string(compression)};
  }

  /// Of the chunk before; one that is not as it must be leaves the chunk without an index.
  static void add_index(const FileRecord& record, const Ros1Fields& header, FileLayout& layout) {
    if (layout.chunks.empty()) throw BadBytes("an index without a chunk");
    Chunk& chunk = layout.chunks.back();
    const IndexPlace place = {header.u32("conn"), record.data_offset, header.u32("count")};
    if (header.u32("ver") != kIndexVersion || record.data_size > kMostSmallBytes ||
        record.data_size != kIndexEntryBytes * place.count)
      throw BadBytes("an index is damaged");
    const bool is_there_already = std::ranges::count(chunk.index, place.channel, &IndexPlace::channel) > 0;
    if (is_there_already) throw BadBytes("an index is there twice");
    chunk.index.push_back(place);
    chunk.has_index = true;
  }

  /// Where the next chunk begins, from a place on that is no record, or one that goes on beyond the file.
  std::uint64_t find_next(std::uint64_t position, FileLayout& layout, Damage& damage) {
    if (auto chunk = overlong_chunk(position)) {
      const auto next = search(chunk->data_offset);
      if (!next) damage.is_cut(position);
      chunk->data_size = next.value_or(file_->size()) - chunk->data_offset;
      layout.chunks.push_back(*chunk);
      return next.value_or(file_->size());
    }
    Chunk* const before = layout.chunks.empty() ? nullptr : &layout.chunks.back();
    // Without an index behind it, the size of the chunk before is in doubt as well.
    const bool is_in_doubt = before && !before->has_index;
    const auto next = search(is_in_doubt ? before->data_offset : position + 1);
    const std::uint64_t end = next.value_or(file_->size());
    if (is_in_doubt) {
      before->data_size = end - before->data_offset;
      before->is_partial = true;
    }
    if (before) before->has_index = false;
    if (!next && runs_out(position))
      damage.is_cut(position);
    else if (end > position)
      damage.lost_bytes(position, end - position);
    return end;
  }

  /// A chunk whose record begins at `position` and is said to go on beyond the file.
  std::optional<Chunk> overlong_chunk(std::uint64_t position) const {
    try {
      const FileRecord record = read_record(position);
      const Ros1Fields header = record.header();
      if (header.op() != Ros1Op::kChunk || record.end() <= file_->size()) return std::nullopt;
      Chunk chunk = chunk_of(record, header, position);
      chunk.is_partial = true;
      return chunk;
    } catch (const BadBytes&) {
      return std::nullopt;
    }
  }

  /// Whether the file ends before a record that begins like one.
  bool runs_out(std::uint64_t position) const {
    const std::string start = file_->read(position, kMostHeaderBytes);
    try {
      ByteCursor cursor(start);
      const std::uint32_t header_size = cursor.u32();
      if (header_size > start.size() - 4) return header_size <= kMostHeaderBytes;
      Ros1Fields(cursor.take(header_size));
      return cursor.u32() > file_->size() - position - cursor.position();
    } catch (const BadBytes&) {
      return start.size() < 8;
    }
  }

  std::optional<std::uint64_t> search(std::uint64_t from) {
    return window_.first(from,
                         [](std::string_view bytes, std::uint64_t) { return find_chunk_record(bytes, 0); });
  }

  static constexpr std::uint64_t kMostChunkHeader = 256;

  std::shared_ptr<const RandomAccessFile> file_;
  SearchWindow window_{*file_, kMostChunkHeader};
  bool is_closed_ = false;
  std::uint32_t num_chunks_stated_ = 0;
  std::map<std::uint64_t, CountOfChannel> counts_;  ///< By a chunk's place in the file.
};

}  // namespace

std::unique_ptr<ChunkedFormat> ros1_bag(std::shared_ptr<const RandomAccessFile> file) {
  return std::make_unique<Ros1Bag>(std::move(file));
}

}  // namespace apriltrack
