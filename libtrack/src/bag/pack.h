#pragma once

#include <string>
#include <string_view>

#include "apriltrack/bag/mcap_writer.h"

namespace apriltrack {

/// What MCAP calls it: "", "lz4", "zstd".
std::string_view name_of(ChunkPacking packing);

/// One LZ4 or zstd frame, which tells how many bytes it unpacks to; the bytes themselves of kNone.
std::string pack(ChunkPacking packing, std::string_view bytes);

}  // namespace apriltrack
