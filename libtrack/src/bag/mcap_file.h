#pragma once

#include <memory>

#include "chunk_layout.h"
#include "random_access_file.h"

namespace apriltrack {

/// All versions.
inline constexpr std::string_view kMcapFamily = "\x89MCAP";

/// An MCAP file of version 0, the only one there is. Throws Error(kInvalidInput) for another.
std::unique_ptr<ChunkedFormat> mcap_file(std::shared_ptr<const RandomAccessFile> file);

}  // namespace apriltrack
