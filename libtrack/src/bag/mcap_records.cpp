#include "mcap_records.h"

#include "walk_records.h"

namespace apriltrack {

McapRecord take_mcap_record(ByteCursor& cursor) {
  const auto op = static_cast<McapOp>(cursor.u8());
  const std::uint64_t size = cursor.u64();
  return {op, cursor.take(size)};
}

bool McapChannels::take(const McapRecord& record) {
  if (record.op != McapOp::kSchema && record.op != McapOp::kChannel) return false;
  ByteCursor cursor(record.content);
  const std::uint16_t id = cursor.u16();
  if (record.op == McapOp::kSchema) {
    const std::string_view name = cursor.sized();
    const std::string_view encoding = cursor.sized();
    schemas_.insert_or_assign(id, McapSchema{std::string(name), std::string(encoding)});
    return true;
  }
  const auto schema = schemas_.find(cursor.u16());
  const std::string_view topic = cursor.sized();
  const std::string_view encoding = cursor.sized();
  const McapSchema known = schema == schemas_.end() ? McapSchema() : schema->second;
  channels_.insert_or_assign(
      id, BagChannel{std::string(topic), known.name, std::string(encoding), known.encoding});
  return true;
}

ChunkContents walk_mcap(std::string_view unpacked, const std::vector<std::uint32_t>& hints,
                        McapChannels& channels) {
  ChunkContents contents = walk_records(unpacked, hints, [&](ByteCursor& cursor, ChunkContents& found) {
    const auto offset = static_cast<std::uint32_t>(cursor.position());
    const McapRecord record = take_mcap_record(cursor);
    if (static_cast<std::uint8_t>(record.op) == 0) throw BadBytes("a record is of no kind that is known");
    if (record.op != McapOp::kMessage) {
      channels.take(record);
      return;
    }
    ByteCursor fields(record.content);
    const std::uint16_t channel = fields.u16();
    fields.u32();  // sequence
    const auto log_time_ns = static_cast<std::int64_t>(fields.u64());
    fields.u64();  // publish time
    found.messages.push_back({channel, log_time_ns, offset, record.content.substr(fields.position())});
  });
  contents.channels = channels.channels();
  return contents;
}

McapChunkHeader read_chunk_header(std::string_view start) {
  ByteCursor cursor(start);
  cursor.take(16);  // first and last time
  McapChunkHeader header;
  header.unpacked_size = cursor.u64();
  header.crc = cursor.u32();
  header.compression = cursor.sized();
  header.data_size = cursor.u64();
  header.header_size = cursor.position();
  return header;
}

namespace {

bool is_mcap_chunk(std::string_view bytes, std::size_t begin) {
  try {
    ByteCursor cursor(bytes, begin + 1);
    const std::uint64_t size = cursor.u64();
    const McapChunkHeader header = read_chunk_header(bytes.substr(cursor.position(), kMostChunkHeaderBytes));
    return packing_of(header.compression) && size == header.header_size + header.data_size;
  } catch (const BadBytes&) {
    return false;
  }
}

bool is_chain(std::string_view bytes, std::size_t begin, std::uint64_t bytes_behind) {
  constexpr int kLength = 4;
  ByteCursor cursor(bytes, begin);
  try {
    for (int i = 0; i < kLength; ++i) {
      const std::uint8_t op = cursor.u8();
      if (op == 0 || op > static_cast<std::uint8_t>(McapOp::kDataEnd)) return false;
      const std::uint64_t size = cursor.u64();
      if (op == static_cast<std::uint8_t>(McapOp::kFooter)) return size == 20;
      if (i > 0 && size > bytes.size() - cursor.position())
        return size <= bytes.size() - cursor.position() + bytes_behind;
      cursor.take(size);
    }
    return true;
  } catch (const BadBytes&) {
    return false;
  }
}

}  // namespace

std::size_t find_mcap_record(std::string_view bytes, bool only_chunks, std::uint64_t bytes_behind) {
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const auto op = static_cast<unsigned char>(bytes[at]);
    if (op == 0 || op > static_cast<std::uint8_t>(McapOp::kDataEnd)) continue;
    const bool is_chunk = op == static_cast<std::uint8_t>(McapOp::kChunk);
    if (is_chunk ? is_mcap_chunk(bytes, at) : !only_chunks && is_chain(bytes, at, bytes_behind)) return at;
  }
  return std::string_view::npos;
}

}  // namespace apriltrack
