#pragma once

#include <cstdint>
#include <string_view>

#include "chunk_layout.h"
#include "mcap_records.h"
#include "random_access_file.h"

namespace apriltrack {

/// What an MCAP file of major version 0 begins and ends with.
inline constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
/// Of a message index, two numbers of eight bytes for each message.
inline constexpr std::uint64_t kMcapIndexEntryBytes = 16;
/// Schemas of deep types have some 100 kB.
inline constexpr std::uint64_t kMostSmallRecordBytes = std::uint64_t{64} << 20;

/// A record in the file, its content left where it is.
struct McapPrefix {
  McapOp op = McapOp::kHeader;
  std::uint64_t content = 0;  ///< Where it begins.
  std::uint64_t size = 0;
  std::uint64_t end() const { return content + size; }
};

// All throw BadBytes.
McapPrefix read_mcap_prefix(const RandomAccessFile& file, std::uint64_t position);
/// content: of a message index, whole; at: where it begins in the file.
void add_message_index(std::string_view content, std::uint64_t at, Chunk& chunk);
/// Takes a record of the data section that begins at `position` into the layout. True where the data end.
bool take_mcap_data(const RandomAccessFile& file, const McapPrefix& prefix, std::uint64_t position,
                    McapChannels& channels, FileLayout& layout);

}  // namespace apriltrack
