#include "mcap_write_records.h"

#include "apriltrack/base/version.h"
#include "apriltrack/io/crc32.h"
#include "mcap_data.h"
#include "pack.h"

namespace apriltrack {

void append_record(ByteWriter& bytes, McapOp op, const ByteWriter& content) {
  bytes.u8(static_cast<std::uint8_t>(op)).u64(content.bytes().size()).raw(content.bytes());
}

ByteWriter header_record(const std::string& profile) {
  ByteWriter content;
  content.sized(profile).sized(std::string(kMcapLibrary) + version());
  return content;
}

ByteWriter chunk_index_record(const McapChunkIndex& chunk, ChunkPacking packing) {
  ByteWriter offsets;
  for (const auto& [topic, offset] : chunk.indices) offsets.u16(topic).u64(offset);
  ByteWriter content;
  chunk.times.append_to(content);
  content.u64(chunk.begin).u64(chunk.length).sized(offsets.bytes()).u64(chunk.indices_length);
  content.sized(name_of(packing)).u64(chunk.packed_size).u64(chunk.unpacked_size);
  return content;
}

ByteWriter schema_record(std::uint16_t id, const McapTopic& topic) {
  ByteWriter content;
  content.u16(id).sized(topic.schema_name).sized(topic.schema_encoding).sized(topic.schema);
  return content;
}

ByteWriter channel_record(std::uint16_t id, std::uint16_t schema, const McapTopic& topic) {
  ByteWriter content;
  content.u16(id).u16(schema).sized(topic.name).sized(topic.message_encoding).sized("");  // no metadata
  return content;
}

ByteWriter message_index_record(std::uint16_t topic, const std::vector<McapIndexEntry>& entries) {
  ByteWriter places;
  for (const McapIndexEntry& entry : entries) places.u64(entry.time_ns).u64(entry.offset);
  ByteWriter content;
  content.u16(topic).sized(places.bytes());
  return content;
}

ByteWriter statistics_record(const McapStatistics& statistics) {
  ByteWriter counts;
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < statistics.counts.size(); ++i) {
    counts.u16(static_cast<std::uint16_t>(i + 1)).u64(statistics.counts[i]);
    all += statistics.counts[i];
  }
  ByteWriter content;
  content.u64(all).u16(static_cast<std::uint16_t>(statistics.num_schemas));
  content.u32(static_cast<std::uint32_t>(statistics.counts.size())).u32(0).u32(0);  // attachments, metadata
  content.u32(static_cast<std::uint32_t>(statistics.num_chunks));
  statistics.times.append_to(content);
  content.sized(counts.bytes());
  return content;
}

std::string summary_section(std::uint64_t begin,
                            const std::vector<std::pair<McapOp, std::vector<ByteWriter>>>& groups) {
  ByteWriter bytes, offsets;
  for (const auto& [op, group] : groups) {
    if (group.empty()) continue;
    const std::uint64_t group_begin = bytes.bytes().size();
    for (const ByteWriter& content : group) append_record(bytes, op, content);
    ByteWriter place;
    place.u8(static_cast<std::uint8_t>(op)).u64(begin + group_begin).u64(bytes.bytes().size() - group_begin);
    append_record(offsets, McapOp::kSummaryOffset, place);
  }
  const std::uint64_t offsets_begin = begin + bytes.bytes().size();
  bytes.raw(offsets.bytes());
  // The CRC is of all from the summary's begin up to itself.
  bytes.u8(static_cast<std::uint8_t>(McapOp::kFooter)).u64(20).u64(begin).u64(offsets_begin);
  bytes.u32(crc32(bytes.bytes())).raw(kMcapMagic);
  return bytes.bytes();
}

}  // namespace apriltrack
