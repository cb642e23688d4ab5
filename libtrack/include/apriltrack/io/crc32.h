#pragma once

#include <cstdint>
#include <string_view>

namespace apriltrack {

/// CRC-32 of IEEE 802.3 (reflected polynomial EDB88320), as zlib, PNG and MCAP have it. before: that of the
/// bytes which these follow.
std::uint32_t crc32(std::string_view bytes, std::uint32_t before = 0);

}  // namespace apriltrack
