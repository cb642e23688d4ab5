#include "apriltrack/bag/mcap_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/crc32.h"
#include "apriltrack/io/growing_file.h"
#include "mcap_data.h"
#include "mcap_write_records.h"
#include "pack.h"

namespace apriltrack {
namespace fs = std::filesystem;

class McapWriter::Impl {
 public:
  Impl(StagedFiles& files, const fs::path& path, const McapWriterOptions& options)
      : options_(options), file_(files, path) {
    ByteWriter start;
    start.raw(kMcapMagic);
    append_record(start, McapOp::kHeader, header_record(options_.profile));
    write_data(start.bytes());
  }

  std::uint16_t add(const McapTopic& topic) {
    APRILTRACK_CHECK(channels_.size() < std::numeric_limits<std::uint16_t>::max(), "MCAP has 65535 topics");
    const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
    channels_.push_back(channel_record(id, schema_of(topic), topic));
    append_record(chunk_, McapOp::kChannel, channels_.back());
    counts_.push_back(0);
    return id;
  }

  void write(std::uint16_t topic, Timestamp time, std::string_view message) {
    APRILTRACK_CHECK(!is_closed_, "a closed file takes no messages");
    APRILTRACK_CHECK(topic >= 1 && topic <= channels_.size(), "a topic of add()");
    if (time.ns < 0)
      throw invalid_input(file_.name(),
                          fmt::format("MCAP cannot hold a time before 1970 (is {} s): choose another "
                                      "format",
                                      format_seconds(time)));
    const auto time_ns = static_cast<std::uint64_t>(time.ns);
    index_[topic].push_back({time_ns, chunk_.bytes().size()});
    times_.add(time_ns);
    const std::uint64_t sequence = counts_[topic - 1u]++;
    chunk_.u8(static_cast<std::uint8_t>(McapOp::kMessage)).u64(22 + message.size());
    chunk_.u16(topic).u32(static_cast<std::uint32_t>(sequence)).u64(time_ns).u64(time_ns).raw(message);
    if (chunk_.bytes().size() >= options_.chunk_bytes) end_chunk();
  }

  void close() {
    APRILTRACK_CHECK(!is_closed_, "a file is closed once");
    is_closed_ = true;
    end_chunk();
    ByteWriter crc, end;
    append_record(end, McapOp::kDataEnd, crc.u32(crc_));
    file_.write(end.bytes());
    file_.write(summary());
    file_.close();
  }

 private:
  std::uint16_t schema_of(const McapTopic& topic) {
    const auto key = std::tuple(topic.schema_name, topic.schema_encoding, topic.schema);
    const auto found = std::ranges::find(schema_keys_, key);
    const auto id = static_cast<std::uint16_t>(found - schema_keys_.begin() + 1);
    if (found != schema_keys_.end()) return id;
    schema_keys_.push_back(key);
    schemas_.push_back(schema_record(id, topic));
    append_record(chunk_, McapOp::kSchema, schemas_.back());
    return id;
  }

  void write_data(std::string_view bytes) {
    crc_ = crc32(bytes, crc_);
    file_.write(bytes);
  }

  /// The chunk, and behind it where its messages are.
  void end_chunk() {
    if (chunk_.bytes().empty()) return;
    McapChunkIndex index{.times = times_, .begin = file_.size(), .unpacked_size = chunk_.bytes().size()};
    const std::string packed = pack(options_.packing, chunk_.bytes());
    index.packed_size = packed.size();
    ByteWriter content;
    times_.append_to(content);
    content.u64(index.unpacked_size).u32(crc32(chunk_.bytes())).sized(name_of(options_.packing));
    content.u64(packed.size()).raw(packed);
    ByteWriter record;
    append_record(record, McapOp::kChunk, content);
    index.length = record.bytes().size();
    write_data(record.bytes());
    write_message_indices(index);
    all_times_.add(times_);
    chunks_.push_back(std::move(index));
    chunk_.clear();
    index_.clear();
    times_ = {};
  }

  void write_message_indices(McapChunkIndex& chunk) {
    const std::uint64_t begin = file_.size();
    ByteWriter records;
    for (auto& [topic, entries] : index_) {
      std::ranges::stable_sort(entries, {}, &McapIndexEntry::time_ns);
      chunk.indices[topic] = begin + records.bytes().size();
      append_record(records, McapOp::kMessageIndex, message_index_record(topic, entries));
    }
    chunk.indices_length = records.bytes().size();
    write_data(records.bytes());
  }

  std::string summary() const {
    std::vector<ByteWriter> chunk_indices;
    for (const McapChunkIndex& chunk : chunks_)
      chunk_indices.push_back(chunk_index_record(chunk, options_.packing));
    const ByteWriter statistics = statistics_record({schemas_.size(), chunks_.size(), all_times_, counts_});
    return summary_section(file_.size(), {{McapOp::kSchema, schemas_},
                                          {McapOp::kChannel, channels_},
                                          {McapOp::kStatistics, {statistics}},
                                          {McapOp::kChunkIndex, chunk_indices}});
  }

  McapWriterOptions options_;
  GrowingFile file_;
  std::uint32_t crc_ = 0;  ///< Of all until the end of the data.
  bool is_closed_ = false;

  std::vector<std::tuple<std::string, std::string, std::string>> schema_keys_;
  std::vector<ByteWriter> schemas_, channels_;  ///< Contents of their records; ids are from 1.
  std::vector<std::uint64_t> counts_;           ///< Of each topic's messages.
  std::vector<McapChunkIndex> chunks_;
  McapTimeRange all_times_;

  // Of the chunk that grows:
  ByteWriter chunk_;
  std::map<std::uint16_t, std::vector<McapIndexEntry>> index_;
  McapTimeRange times_;
};

McapWriter::McapWriter(StagedFiles& files, const fs::path& path, const McapWriterOptions& options)
    : impl_(std::make_unique<Impl>(files, path, options)) {}

McapWriter::~McapWriter() = default;

std::uint16_t McapWriter::add(const McapTopic& topic) {
  return impl_->add(topic);
}

void McapWriter::write(std::uint16_t topic, Timestamp time, std::string_view message) {
  impl_->write(topic, time, message);
}

void McapWriter::close() {
  impl_->close();
}

}  // namespace apriltrack
