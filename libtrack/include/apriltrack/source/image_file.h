#pragma once

#include <filesystem>

#include "apriltrack/image/image.h"

namespace apriltrack {

/// Decodes an image file to 8-bit grey (colour is converted with Rec. 601 weights; 16 bits are scaled down by
/// the range that this file uses, see docs/file_formats.md). Throws Error(kIo) when the file is missing, no
/// image, or corrupt.
GrayImage read_image(const std::filesystem::path& path);

/// Format by the file's ending (.png, .jpg, .pgm). Throws Error(kIo), on a full disk too; an existing file is
/// replaced only when the new one is complete.
void write_image(const std::filesystem::path& path, const GrayView& image);

}  // namespace apriltrack
