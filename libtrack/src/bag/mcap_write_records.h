#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apriltrack/bag/mcap_writer.h"
#include "byte_writer.h"
#include "mcap_records.h"

namespace apriltrack {

// What McapWriter writes, as contents of records; mcap_records.h reads them.

/// First and last of some times; 0 where there are none, as MCAP has it.
struct McapTimeRange {
  std::uint64_t first_ns = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;

  void add(std::uint64_t time_ns) {
    first_ns = std::min(first_ns, time_ns);
    last_ns = std::max(last_ns, time_ns);
  }
  void add(const McapTimeRange& other) {
    first_ns = std::min(first_ns, other.first_ns);
    last_ns = std::max(last_ns, other.last_ns);
  }
  void append_to(ByteWriter& bytes) const { bytes.u64(first_ns <= last_ns ? first_ns : 0).u64(last_ns); }
};

struct McapIndexEntry {
  std::uint64_t time_ns = 0;
  std::uint64_t offset = 0;  ///< In the unpacked chunk.
};

/// What the summary tells of a chunk.
struct McapChunkIndex {
  McapTimeRange times = {};
  std::uint64_t begin = 0, length = 0;                  ///< Of the chunk's record.
  std::map<std::uint16_t, std::uint64_t> indices = {};  ///< Where that of each topic begins.
  std::uint64_t indices_length = 0;
  std::uint64_t packed_size = 0, unpacked_size = 0;
};

/// What the summary's statistics tell.
struct McapStatistics {
  std::size_t num_schemas = 0;
  std::size_t num_chunks = 0;
  McapTimeRange times = {};
  std::vector<std::uint64_t> counts = {};  ///< Of each topic's messages; topics are numbered from 1.
};

void append_record(ByteWriter& bytes, McapOp op, const ByteWriter& content);

ByteWriter header_record(const std::string& profile);
ByteWriter schema_record(std::uint16_t id, const McapTopic& topic);
ByteWriter channel_record(std::uint16_t id, std::uint16_t schema, const McapTopic& topic);
ByteWriter message_index_record(std::uint16_t topic, const std::vector<McapIndexEntry>& entries);
ByteWriter chunk_index_record(const McapChunkIndex& chunk, ChunkPacking packing);
ByteWriter statistics_record(const McapStatistics& statistics);

/// Groups of records of one kind, where each group is, the footer and the magic.
/// begin: where in the file it will stand.
std::string summary_section(std::uint64_t begin,
                            const std::vector<std::pair<McapOp, std::vector<ByteWriter>>>& groups);

}  // namespace apriltrack
