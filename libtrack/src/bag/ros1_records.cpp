#include "ros1_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "apriltrack/base/timestamp.h"
#include "walk_records.h"

namespace apriltrack {

Ros1Fields::Ros1Fields(std::string_view bytes) {
  ByteCursor cursor(bytes);
  while (!cursor.is_at_end()) {
    const std::string_view field = cursor.sized();
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos || equals == 0) throw BadBytes("a record's header is damaged");
    fields_.push_back({field.substr(0, equals), field.substr(equals + 1)});
  }
}

std::optional<std::string_view> Ros1Fields::find(std::string_view name) const {
  const auto found = std::ranges::find(fields_, name, &Field::name);
  if (found == fields_.end()) return std::nullopt;
  return found->value;
}

std::string_view Ros1Fields::text(std::string_view name) const {
  if (const auto value = find(name)) return *value;
  throw BadBytes(fmt::format("a record has no field '{}'", name));
}

std::uint64_t Ros1Fields::number(std::string_view name, std::size_t size) const {
  const std::string_view value = text(name);
  if (value.size() != size) throw BadBytes(fmt::format("a record's field '{}' has a wrong size", name));
  return little_endian(value);
}

std::int64_t Ros1Fields::time_ns(std::string_view name) const {
  const std::string_view value = text(name);
  if (value.size() != 8) throw BadBytes(fmt::format("a record's field '{}' has a wrong size", name));
  return ros1_time_ns(value);
}

std::int64_t ros1_time_ns(std::string_view eight_bytes) {
  const auto seconds = static_cast<std::int64_t>(little_endian(eight_bytes.substr(0, 4)));
  return seconds * kNsPerSecond + static_cast<std::int64_t>(little_endian(eight_bytes.substr(4, 4)));
}

std::uint32_t connection_id(const Ros1Fields& header) {
  return header.u32("conn");
}

BagChannel connection_channel(const Ros1Fields& header, std::string_view data) {
  const Ros1Fields of_publisher(data);
  return {std::string(header.text("topic")), std::string(of_publisher.text("type")), "ros1", "ros1msg"};
}

namespace {

/// Reads the record at the cursor into `contents`; what is neither message nor connection is passed over.
void take_record(ByteCursor& cursor, ChunkContents& contents) {
  const std::size_t offset = cursor.position();
  const std::string_view header_bytes = cursor.sized();
  const Ros1Fields header(header_bytes);
  const Ros1Op op = header.op();
  const std::string_view data = cursor.sized();
  if (op == Ros1Op::kMessage) {
    contents.messages.push_back(
        {header.u32("conn"), header.time_ns("time"), static_cast<std::uint32_t>(offset), data});
  } else if (op == Ros1Op::kConnection) {
    contents.channels.insert_or_assign(connection_id(header), connection_channel(header, data));
  } else if (op != Ros1Op::kIndex && op != Ros1Op::kChunkInfo && op != Ros1Op::kFileHeader) {
    throw BadBytes("a record is of no kind that is known");
  }
}

/// Whether the header of a chunk's record begins there.
bool is_ros1_chunk(std::string_view bytes, std::size_t begin) {
  try {
    ByteCursor cursor(bytes, begin);
    const Ros1Fields header(cursor.sized());
    return header.op() == Ros1Op::kChunk && packing_of(header.text("compression")) && header.u32("size") > 0;
  } catch (const BadBytes&) {
    return false;
  }
}

}  // namespace

ChunkContents walk_ros1(std::string_view unpacked, const std::vector<std::uint32_t>& hints) {
  return walk_records(unpacked, hints, take_record);
}

std::size_t find_chunk_record(std::string_view bytes, std::size_t from) {
  constexpr std::string_view kName = "compression=";
  // Writers put the field first, behind op, behind size, or behind both. Each field has its length before it,
  // and so has the header.
  constexpr std::size_t kOp = 4 + 4, kSize = 4 + 9, kLengths = 4 + 4;
  constexpr std::array kBefore = {kLengths, kLengths + kOp, kLengths + kSize, kLengths + kOp + kSize};
  for (std::size_t at = bytes.find(kName, from); at != std::string_view::npos;
       at = bytes.find(kName, at + 1)) {
    for (const std::size_t before : kBefore)
      if (at >= from + before && is_ros1_chunk(bytes, at - before)) return at - before;
  }
  return std::string_view::npos;
}

}  // namespace apriltrack
