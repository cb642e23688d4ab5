#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace apriltrack {

/// Tags of TIFF 6.0, section 8, which EXIF shares.
constexpr std::uint16_t kTiffImageWidth = 256;
constexpr std::uint16_t kTiffImageLength = 257;
constexpr std::uint16_t kTiffOrientation = 274;

/// The value of a tag (SHORT or LONG, one of them) in the first directory of a TIFF file, or of an EXIF block
/// from its byte order on; nullopt where there is none.
std::optional<std::int64_t> tiff_value(std::string_view tiff, std::uint16_t tag);

}  // namespace apriltrack
